// Tests of pairs of patches on the device: quarters of patches by their boxes, parts by planes,
// then triangles. On level 1, where quarters are triangles, planes come first, between patches.
//
// Each test drops most of what it sees, so lanes with something left would be few in a warp. The
// first tests are kernels of their own, with a list between them: none holds the registers of
// another. In the last one a warp collects what is left in a queue in shared memory until it has
// work for all lanes.
#pragma once

#include "cuda/memory/warp.cuh"
#include "cuda/refine/device_crossings.cuh"
#include "refine/crossings/crossing_formulas.hpp"

namespace vdwmesh {

inline constexpr unsigned kTestThreads = 128;  // per block

// Reserves room in a list for the `mine` elements of each lane, and returns where those of the lane
// begin. All lanes of a warp must call it together.
__device__ inline unsigned long long reserve(unsigned long long* count, unsigned mine) {
  const std::uint32_t through = warp_inclusive_sum(mine);
  unsigned long long begin = 0;
  if (threadIdx.x % kWarp == kWarp - 1 && through > 0) begin = atomicAdd(count, 1ull * through);
  return __shfl_sync(kAllLanes, begin, kWarp - 1) + through - mine;
}

// The corners of a triangle.
struct TriangleCorners {
  std::uint32_t vertex[3];
  Vec3d position[3];
  SphereId atom[3];
};

__device__ inline void load_vertices(const DeviceMeshView& mesh, std::uint64_t t,
                                     std::uint32_t* vertex) {
  for (int k = 0; k < 3; ++k) vertex[k] = mesh.corners[3 * t + k];
}

__device__ inline void load_places(const DeviceMeshView& mesh, TriangleCorners& c) {
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

__device__ inline bool is_crossing(const TriangleCorners& a, const TriangleCorners& b) {
  return boxes_overlap(a.position, b.position) &&
         triangles_cross(a.position, a.vertex, a.atom, b.position, b.vertex, b.atom);
}

// Whether triangles s and t may cross: whether they have a moved vertex and no common edge, and
// their boxes overlap. triangles_cross() asks again for edges; here pairs are dropped that would
// keep lanes of it idle.
__device__ inline bool may_cross(const DeviceMeshView& mesh, const MoveStatesView& move_states,
                                 std::uint64_t s, std::uint64_t t) {
  TriangleCorners a, b;
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
  TriangleCorners a, b;
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
    if (has) pairs_[size_ + bits_below(lanes, lane)] = pair;
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

// Of each pair of parts a, b that a lane has, the first `count` lanes one, there are 16 pairs of
// triangles: 4 a + i for i < 4 with 4 b + j. Calls visit(has, triangles) for two pairs of parts at
// a time, half a warp for each; `has` is false in lanes without a pair. All lanes must call it
// together.
template <class Visit>
__device__ void visit_triangles_of_parts(const NumberPair& pair, unsigned count,
                                         const Visit& visit) {
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
// other. refine/crossings/patch_outline.hpp has the definition of walls, the proof, and that of the
// margin. `reach` is the largest coordinate of both.
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

// ---- kernels, in the order in which pairs pass through them ----

// Lists the pairs of quarters with overlapping boxes, of listed pairs of patches: number 4 a + i
// for i < 4 with number 4 b + j. Of a patch with itself these are pairs of two quarters, and of
// parts also each part with itself. Pairs of kNoNumber have none. One thread per pair; the list
// must have room for 16 pairs of each.
template <class Patches>
__global__ void __launch_bounds__(kTestThreads)
    list_quarters(const FloatBox* quarters, const NumberPair* pairs, std::uint64_t count,
                  NumberPair* near, unsigned long long* found) {
  // Of a patch with itself: the bits with k < j, and for parts those with k == j.
  constexpr unsigned kInOrder = Patches::kHasParts ? 0x8cefu : 0x08ceu;
  const std::uint64_t i = thread_index();
  NumberPair pair{kNoNumber, 0};
  if (i < count) pair = pairs[i];
  unsigned overlapping = 0;  // bit 4 k + j: quarter k of a with quarter j of b
  if (pair.a != kNoNumber) {
    FloatBox others[4];
    for (int j = 0; j < 4; ++j) others[j] = quarters[4 * std::uint64_t{pair.b} + j];
    for (int k = 0; k < 4; ++k) {
      const FloatBox own = quarters[4 * std::uint64_t{pair.a} + k];
      for (int j = 0; j < 4; ++j) {
        overlapping |= overlap(own, others[j]) ? 1u << (4 * k + j) : 0;
      }
    }
    if (pair.a == pair.b) overlapping &= kInOrder;
  }
  unsigned long long slot = reserve(found, static_cast<unsigned>(__popc(overlapping)));
  for (; overlapping != 0; overlapping &= overlapping - 1, ++slot) {
    const unsigned bit = static_cast<unsigned>(__ffs(static_cast<int>(overlapping))) - 1;
    near[slot] = {4 * pair.a + bit / 4, 4 * pair.b + bit % 4};
  }
}

// Makes listed pairs that a wall keeps apart pairs of kNoNumber: pairs of parts, on level 1 of
// patches. There are *count of them, or `most` if `count` is null.
static __global__ void __launch_bounds__(kTestThreads)
    drop_kept_apart(MidpointLevel level, NumberPair* pairs, std::uint64_t most,
                    const unsigned long long* count) {
  const std::uint64_t end = count != nullptr ? *count : most;
  const std::uint64_t step = std::uint64_t{gridDim.x} * blockDim.x;
  for (std::uint64_t i = thread_index(); i < end; i += step) {
    const NumberPair pair = pairs[i];
    if (pair.a != pair.b && kept_apart(level, pair)) pairs[i].a = kNoNumber;
  }
}

// Calls visit(has, pair) for 32 listed pairs at a time, one for each lane, in all lanes of a warp
// together; `has` is false in lanes without a pair.
template <class Visit>
__device__ void visit_listed(const NumberPair* pairs, const unsigned long long* count,
                             const Visit& visit) {
  const std::uint64_t end = *count, step = std::uint64_t{gridDim.x} * blockDim.x;
  const unsigned lane = threadIdx.x % kWarp;
  for (std::uint64_t first = thread_index() - lane; first < end; first += step) {
    NumberPair pair{kNoNumber, 0};
    if (first + lane < end) pair = pairs[first + lane];
    visit(pair.a != kNoNumber, pair);
  }
}

// The triangles of a warp that are to be tested by the formula, which begins when all lanes have a
// pair.
class TriangleQueue {
 public:
  __device__ TriangleQueue(const DeviceMeshView& mesh, const MoveStatesView& move_states,
                           NumberPair* room)
      : mesh_(mesh), move_states_(move_states), queue_(room) {}
  __device__ void push(bool has, const NumberPair& pair) {
    queue_.push(has && may_cross(mesh_, move_states_, pair.a, pair.b), pair);
    test(kWarp);
  }
  __device__ void finish() { test(1); }

 private:
  __device__ void test(unsigned least) {
    while (queue_.size() >= least) {
      NumberPair t{0, 0};
      if (threadIdx.x % kWarp < queue_.pop(t)) mark_if_crossing(mesh_, move_states_, t.a, t.b);
      __syncwarp();
    }
  }
  const DeviceMeshView& mesh_;
  const MoveStatesView& move_states_;
  PairQueue queue_;
};

// Tests listed pairs of triangles and marks the vertices of those that cross.
static __global__ void __launch_bounds__(kTestThreads)
    test_triangles(DeviceMeshView mesh, MoveStatesView move_states, const NumberPair* pairs,
                   const unsigned long long* count) {
  __shared__ NumberPair room[kTestThreads / kWarp][PairQueue::kRoom];
  TriangleQueue triangles(mesh, move_states, room[threadIdx.x / kWarp]);
  visit_listed(pairs, count, [&](bool has, const NumberPair& pair) { triangles.push(has, pair); });
  triangles.finish();
}

// The same for listed pairs of parts, each with four triangles.
static __global__ void __launch_bounds__(kTestThreads)
    test_parts(DeviceMeshView mesh, MoveStatesView move_states, const NumberPair* pairs,
               const unsigned long long* count) {
  __shared__ NumberPair room[kTestThreads / kWarp][PairQueue::kRoom];
  __shared__ NumberPair part_room[kTestThreads / kWarp][PairQueue::kRoom];
  TriangleQueue triangles(mesh, move_states, room[threadIdx.x / kWarp]);
  PairQueue parts(part_room[threadIdx.x / kWarp]);
  const auto test = [&](unsigned least) {
    while (parts.size() >= least) {
      NumberPair part{0, 0};
      const unsigned taken = parts.pop(part);
      visit_triangles_of_parts(part, taken, [&](bool has, const NumberPair& t) {
        const bool in_order = t.a / 4 != t.b / 4 || t.a < t.b;
        triangles.push(has && in_order, t);
      });
    }
  };
  visit_listed(pairs, count, [&](bool has, const NumberPair& pair) {
    parts.push(has, pair);
    test(kWarp);
  });
  test(1);
  triangles.finish();
}

}  // namespace vdwmesh
