// Tests of pairs of patches on the device: pieces of patches by their boxes, then triangles.
//
// Each test drops most of what it sees, so lanes with something left would be few in a warp. The
// warp therefore collects what is left in a queue in shared memory until it has work for all lanes.
#pragma once

#include "cuda/memory/warp.cuh"
#include "cuda/refine/device_crossings.cuh"
#include "refine/crossing_formulas.hpp"

namespace vdwmesh {

inline constexpr unsigned kTestThreads = 128;  // of a block

// The corners of a triangle.
struct Corners {
  std::uint32_t vertex[3];
  Vec3d position[3];
  SphereId atom[3];
};

__device__ inline void load_vertices(const DeviceMeshView& mesh, std::uint64_t t,
                                     std::uint32_t* vertex) {
  for (int k = 0; k < 3; ++k) vertex[k] = mesh.corners[3 * t + k];
}

__device__ inline void load_places(const DeviceMeshView& mesh, Corners& c) {
  for (int k = 0; k < 3; ++k) {
    c.position[k] = mesh.positions[c.vertex[k]];
    c.atom[k] = mesh.vertex_spheres.atoms[c.vertex[k]];
  }
}

// Whether a vertex of the triangle is where its move led. Other threads may mark vertices
// meanwhile: a marked vertex still counts as away, so the result does not depend on their order.
__device__ inline bool is_away(const MoveStatesView& move_states, const std::uint32_t* vertex) {
  bool away = false;
  for (int k = 0; k < 3; ++k) away |= has_wanted_state(move_states, vertex[k], 0);
  return away;
}

__device__ inline bool is_crossing(const Corners& a, const Corners& b) {
  return boxes_overlap(a.position, b.position) &&
         triangles_cross(a.position, a.vertex, a.atom, b.position, b.vertex, b.atom);
}

// Whether triangles s and t may cross: whether they have a moved vertex and no common edge, and
// their boxes overlap. triangles_cross() asks again for edges; here pairs are dropped that would
// keep lanes of it idle.
__device__ inline bool may_cross(const DeviceMeshView& mesh, const MoveStatesView& move_states,
                                 std::uint64_t s, std::uint64_t t) {
  Corners a, b;
  load_vertices(mesh, s, a.vertex);
  load_vertices(mesh, t, b.vertex);
  int shared = 0;
  for (const std::uint32_t v : a.vertex) {
    shared += v == b.vertex[0] || v == b.vertex[1] || v == b.vertex[2] ? 1 : 0;
  }
  if (shared > 1) return false;
  if (!is_away(move_states, a.vertex) && !is_away(move_states, b.vertex)) return false;
  for (int k = 0; k < 3; ++k) {
    a.position[k] = mesh.positions[a.vertex[k]];
    b.position[k] = mesh.positions[b.vertex[k]];
  }
  return boxes_overlap(a.position, b.position) != 0;
}

// Marks the moved vertices of triangles s and t if they cross. Pairs without a moved vertex are not
// tested.
__device__ inline void mark_if_crossing(const DeviceMeshView& mesh,
                                        const MoveStatesView& move_states, std::uint64_t s,
                                        std::uint64_t t) {
  Corners a, b;
  load_vertices(mesh, s, a.vertex);
  load_vertices(mesh, t, b.vertex);
  if (!is_away(move_states, a.vertex) && !is_away(move_states, b.vertex)) return;
  load_places(mesh, a);
  load_places(mesh, b);
  if (!is_crossing(a, b)) return;
  for (int k = 0; k < 3; ++k) {
    move_states.mark(a.vertex[k]);
    move_states.mark(b.vertex[k]);
  }
}

// A queue of pairs in shared memory that belongs to a warp, with room for one push of all lanes
// while less than a warp is waiting. All lanes must call its members together.
class PairQueue {
 public:
  static constexpr unsigned kRoom = 2 * kWarp;
  __device__ explicit PairQueue(NumberPair* room) : pairs_(room) {}

  __device__ unsigned size() const { return size_; }
  // Appends the pairs of the lanes that have one.
  __device__ inline void push(bool has, const NumberPair& pair) {
    const unsigned lanes = __ballot_sync(kAllLanes, has), lane = threadIdx.x % kWarp;
    if (has) pairs_[size_ + static_cast<unsigned>(__popc(lanes & ((1u << lane) - 1)))] = pair;
    size_ += static_cast<unsigned>(__popc(lanes));
    __syncwarp();
  }
  // Takes a pair for each lane, as far as there are any, and returns how many lanes have one: the
  // first ones.
  __device__ unsigned pop(NumberPair& pair) {
    const unsigned taken = size_ < kWarp ? size_ : kWarp, lane = threadIdx.x % kWarp;
    size_ -= taken;
    if (lane < taken) pair = pairs_[size_ + lane];
    __syncwarp();
    return taken;
  }

 private:
  NumberPair* pairs_;
  unsigned size_ = 0;
};

// Of each pair that a lane has, the first `count` lanes one, there are 16 pairs of quarters: number
// 4 a + i for i < 4 with number 4 b + j. Calls visit(has, quarters) for two pairs at a time, half a
// warp for each; `has` is false in lanes without a pair. All lanes must call it together.
template <class Visit>
__device__ void visit_quarters(const NumberPair& pair, unsigned count, const Visit& visit) {
  constexpr unsigned kHalf = kWarp / 2;
  const unsigned lane = threadIdx.x % kWarp;
  for (unsigned first = 0; first < count; first += 2) {
    const unsigned from = first + lane / kHalf;
    const std::uint32_t a = __shfl_sync(kAllLanes, pair.a, static_cast<int>(from)),
                        b = __shfl_sync(kAllLanes, pair.b, static_cast<int>(from));
    visit(from < count, NumberPair{4 * a + lane % kHalf / 4, 4 * b + lane % 4});
  }
}

// A part of a patch, the four children of a parent triangle: its corners, and the midpoints of the
// edges from each corner to the next one.
struct PartOutline {
  std::uint32_t vertex[6];
  Vec3d position[6];  // Å, relative to a vertex of one of the parts that are compared
};

__device__ inline void load_part(const MidpointLevel& level, std::uint64_t part,
                                 PartOutline& outline) {
  for (int k = 0; k < 3; ++k) {
    outline.vertex[k] = level.parent.corners[3 * part + k];
    outline.vertex[3 + k] = level.mesh.corners[3 * (4 * part + 3) + k];
  }
  for (int i = 0; i < 6; ++i) outline.position[i] = level.mesh.positions[outline.vertex[i]];
}

// Whether a wall of part a keeps out part b, so that no triangle of one crosses a triangle of the
// other. refine/patch_outline.hpp has the definition of walls, the proof, and that of the margin.
// `reach` is the largest coordinate of both.
__device__ inline bool keeps_out(const PartOutline& a, const PartOutline& b, double reach) {
  const double margin = 0x1p-40 * reach * reach;
#pragma unroll
  for (int k = 0; k < 3; ++k) {
    const int next = k == 2 ? 0 : k + 1, last = k == 0 ? 2 : k - 1;
    const Vec3d &u = a.position[k], &v = a.position[next], &m = a.position[3 + k];
    const Vec3d edge = v - u, up = m - 0.5 * (u + v);
    const Vec3d size = magnitudes(edge) + magnitudes(up);
    const double strictly = margin * (size.x + size.y + size.z);
    const Vec3d normal = cross(edge, up);
    const double of_edge = dot(normal, u), side = dot(normal, a.position[last]) - of_edge;
    const double sign = side > 0 ? 1 : -1;
    const double others[2] = {dot(normal, a.position[3 + next]) - of_edge,
                              dot(normal, a.position[3 + last]) - of_edge};
    if (!(sign * side > strictly && sign * others[0] > strictly && sign * others[1] > strictly)) {
      continue;
    }
    bool out = true;
    for (int i = 0; i < 6; ++i) {
      const std::uint32_t w = b.vertex[i];
      out &= sign * dot(normal, b.position[i]) < sign * of_edge - strictly || w == a.vertex[k] ||
             w == a.vertex[next] || w == a.vertex[3 + k];
    }
    if (out) return true;
  }
  return false;
}

// Whether a wall keeps two different parts apart.
__device__ inline bool kept_apart(const MidpointLevel& level, const NumberPair& parts) {
  PartOutline a, b;
  load_part(level, parts.a, a);
  load_part(level, parts.b, b);
  const Vec3d origin = a.position[0];
  double reach = 0;
  for (PartOutline* part : {&a, &b}) {
    for (Vec3d& p : part->position) {
      p = p - origin;
      const Vec3d size = magnitudes(p);
      reach = fmax(reach, fmax(size.x, fmax(size.y, size.z)));
    }
  }
  return keeps_out(a, b, reach) || keeps_out(b, a, reach);
}

// Tests the triangles of pairs of patches and marks the vertices of those that cross. A warp takes
// 32 pairs; for level 0 a thread takes one. Pairs with numbers a > b of equal patches or parts are
// the same as those with b > a.
template <class Patches>
__global__ void __launch_bounds__(kTestThreads)
    test_pairs(Patches level, const FloatBox* pieces, MoveStatesView move_states,
               const NumberPair* pairs, std::uint64_t count) {
  const std::uint64_t first = thread_index() / kWarp * kWarp;
  const unsigned lane = threadIdx.x % kWarp;
  if (first >= count) return;  // a whole warp
  const unsigned here = count - first < kWarp ? static_cast<unsigned>(count - first) : kWarp;
  const NumberPair pair = lane < here ? pairs[first + lane] : NumberPair{0, 0};
  if constexpr (Patches::kPieces == 0) {
    if (lane < here) mark_if_crossing(level.mesh, move_states, pair.a, pair.b);
  } else {
    constexpr bool has_parts = Patches::kTriangles > Patches::kPieces;
    __shared__ NumberPair triangle_room[kTestThreads / kWarp][PairQueue::kRoom];
    PairQueue triangles(triangle_room[threadIdx.x / kWarp]);
    const auto test = [&](unsigned least) {
      while (triangles.size() >= least) {
        NumberPair t{0, 0};
        if (lane < triangles.pop(t)) mark_if_crossing(level.mesh, move_states, t.a, t.b);
        __syncwarp();
      }
    };
    const auto near = [&](const NumberPair& p) { return overlap(pieces[p.a], pieces[p.b]); };
    if constexpr (!has_parts) {
      visit_quarters(pair, here, [&](bool has, const NumberPair& t) {
        const bool in_order = t.a / 4 != t.b / 4 || t.a < t.b;
        triangles.push(has && in_order && near(t), t);
        test(kWarp);
      });
    } else {
      __shared__ NumberPair near_room[kTestThreads / kWarp][PairQueue::kRoom];
      __shared__ NumberPair close_room[kTestThreads / kWarp][PairQueue::kRoom];
      // Pairs of parts: those whose boxes overlap, and those that no wall keeps apart.
      PairQueue near_parts(near_room[threadIdx.x / kWarp]);
      PairQueue close_parts(close_room[threadIdx.x / kWarp]);
      const auto test_close = [&](unsigned least) {
        while (close_parts.size() >= least) {
          NumberPair part{0, 0};
          const unsigned taken = close_parts.pop(part);
          visit_quarters(part, taken, [&](bool has, const NumberPair& t) {
            const bool in_order = t.a / 4 != t.b / 4 || t.a < t.b;
            triangles.push(has && in_order && may_cross(level.mesh, move_states, t.a, t.b), t);
            test(kWarp);
          });
        }
      };
      const auto test_near = [&](unsigned least) {
        while (near_parts.size() >= least) {
          NumberPair part{0, 0};
          const bool has = lane < near_parts.pop(part);
          close_parts.push(has && (part.a == part.b || !kept_apart(level, part)), part);
          test_close(kWarp);
        }
      };
      visit_quarters(pair, here, [&](bool has, const NumberPair& part) {
        const bool in_order = part.a / 4 != part.b / 4 || part.a <= part.b;
        near_parts.push(has && in_order && near(part), part);
        test_near(kWarp);
      });
      test_near(1);
      test_close(1);
    }
    test(1);
  }
}

}  // namespace vdwmesh
