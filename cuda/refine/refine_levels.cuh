// What the kernels of one refinement level share: views of the level's meshes, the states of its
// vertices, marks that let most triangles skip a test, and the counts. The CPU counterpart is
// refine/level_view.hpp. Two words from there: a level "handles" the vertices that it creates or
// projects, and a "patch" is a group of triangles with common vertices (see GivenLevel and
// MidpointLevel).
#pragma once

#include <cstdint>

#include "cuda/memory/device_structures.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/warp.cuh"
#include "cuda/refine/edge_numbers.cuh"
#include "refine/level_view.hpp"
#include "refine/surface_view.hpp"

namespace vdwmesh {

// The counts of ProjectionStats in device memory; kernels add to them atomically. residual_bits is
// the largest residual (Å) as the bits of a double. Residuals are not negative, and the bits of
// such doubles have the order of the numbers, so atomicMax() on integers finds the largest.
struct DeviceStats {
  unsigned long long projected, unconverged, out_of_reach, turned, residual_bits;
  int iterations_max;
};

// Counts of the outcomes of one thread's projections. At its end a warp adds up the counts of its
// lanes, so that few atomic operations reach the shared DeviceStats.
class OutcomeTally {
 public:
  __device__ void add(const ProjectedPoint& p) {
    converged_ += p.outcome == ProjectionOutcome::converged;
    unconverged_ += p.outcome == ProjectionOutcome::unconverged;
    out_of_reach_ += p.outcome == ProjectionOutcome::out_of_reach;
    if (p.steps > steps_) steps_ = p.steps;
    if (p.outcome == ProjectionOutcome::converged && p.residual > residual_) residual_ = p.residual;
  }

  // Adds the tallies of a warp to the stats. All 32 lanes must call it together, once.
  __device__ void add_to(DeviceStats* stats) const {
    const unsigned converged = __reduce_add_sync(kAllLanes, converged_);
    const unsigned unconverged = __reduce_add_sync(kAllLanes, unconverged_);
    const unsigned out_of_reach = __reduce_add_sync(kAllLanes, out_of_reach_);
    const int steps = __reduce_max_sync(kAllLanes, steps_);
    const double residual =
        joined_by_warp(residual_, [](double a, double b) { return b > a ? b : a; });
    if (threadIdx.x % 32 != 0) return;
    if (converged > 0) atomicAdd(&stats->projected, converged);
    if (unconverged > 0) atomicAdd(&stats->unconverged, unconverged);
    if (out_of_reach > 0) atomicAdd(&stats->out_of_reach, out_of_reach);
    // These reads may be out of date, but the values only grow. So the test skips atomic operations
    // that would change nothing, and no others.
    if (steps > stats->iterations_max) atomicMax(&stats->iterations_max, steps);
    const auto bits = static_cast<unsigned long long>(__double_as_longlong(residual));
    if (bits > stats->residual_bits) atomicMax(&stats->residual_bits, bits);
  }

 private:
  unsigned converged_ = 0, unconverged_ = 0, out_of_reach_ = 0;
  int steps_ = 0;
  double residual_ = 0;
};

// The states of the vertices that a level handles (see MoveState), and a list of the vertices whose
// moves the current pass has marked as bad. The handled vertices are the last ones of the mesh;
// their numbers count from first_handled.
struct MoveStatesView {
  MoveState* move_states;  // one byte per handled vertex, in an array of move_state_bytes() bytes
  std::uint64_t first_handled;  // vertex index of the first handled vertex
  unsigned long long* marked;   // how many vertices the pass has marked
  std::uint32_t* list;          // the first `room` of the marked vertices, as numbers, in any order
  std::uint64_t room;           // length of the array `list`; 0 if no list is kept

  // The state of vertex v, handled or not. The load is volatile because other threads may be
  // marking the vertex.
  __device__ MoveState of(std::uint32_t v) const {
    if (v < first_handled) return MoveState::stayed;
    return *const_cast<const volatile MoveState*>(&move_states[v - first_handled]);
  }
  // Changes the state of v from `moved` to `to_undo`, and lists v. Does nothing in other states. If
  // several threads mark v at once, only the one whose compare-and-swap succeeds counts and lists
  // it. CUDA swaps 32-bit words at least: here the aligned word that holds the states of v and of
  // three others. If one of these changes meanwhile, the loop tries again.
  __device__ void mark(std::uint32_t v) const {
    if (of(v) != MoveState::moved) return;
    const std::uint64_t i = v - first_handled;
    auto* const word = reinterpret_cast<unsigned*>(move_states) + i / 4;
    const unsigned shift = 8 * static_cast<unsigned>(i % 4);
    const auto state_in = [=](unsigned bits) {
      return static_cast<MoveState>(bits >> shift & 0xff);
    };
    for (unsigned seen = *const_cast<volatile unsigned*>(word);;) {
      if (state_in(seen) != MoveState::moved) return;
      const unsigned marks = static_cast<unsigned>(MoveState::to_undo) << shift;
      const unsigned old = atomicCAS(word, seen, (seen & ~(0xffu << shift)) | marks);
      if (old == seen) break;
      seen = old;
    }
    const unsigned long long slot = atomicAdd(marked, 1ull);
    if (slot < room) list[slot] = static_cast<std::uint32_t>(i);
  }
};

// Bytes of an array of states: whole words of four bytes, since MoveStatesView::mark() swaps words.
inline std::uint64_t move_state_bytes(std::uint64_t handled) { return (handled + 3) / 4 * 4; }

__device__ inline VertexSpheres make_label(const SphereId* s) { return {s[0], s[1], s[2]}; }

// Level 0: every vertex is handled, and a patch is one triangle. The members with counterparts in
// MidpointLevel have the same names, for code that is a template over the level.
struct GivenLevel {
  static constexpr int kVertices = 3, kTriangles = 1;  // per patch
  DeviceMeshView given, mesh;  // before and after the projection; only positions and labels differ

  __host__ __device__ std::uint64_t patches() const { return given.triangles; }
  // Corner k of a triangle of a patch, as an index into the patch's vertices. The first argument is
  // the number of the triangle in the patch, here always 0.
  __device__ int corner(int, int k) const { return k; }
  // Vertex i of patch t as a vertex of the mesh, and its position before its move.
  __device__ std::uint32_t vertex(std::uint64_t t, int i) const { return given.corners[3 * t + i]; }
  __device__ Vec3d before(std::uint64_t t, int i) const { return given.positions[vertex(t, i)]; }
  // Puts vertex v back where it was given, with its given label, and renews its normal.
  __device__ void take_back(const SurfaceView& surface, std::uint64_t v) const {
    mesh.positions[v] = given.positions[v];
    const VertexSpheres label = given.vertex_spheres[v];
    mesh.vertex_spheres.set(v, label);
    if (mesh.normals != nullptr) {
      mesh.normals[v] = surface.normal(mesh.positions[v], ids(label));
    }
  }
};

// Marks that let most patches skip the test of their children's orientation.
//
// A midpoint is regular if both ends of its edge have one atom and the midpoint went radially to
// the sphere of that atom. A triangle is safe if its corners have one atom and it faces outward by
// a wide margin, see is_safe() in patch_facing.cuh. The children of a safe triangle whose three
// midpoints are regular face outward too, and count as safe in turn.
//
// The proof is about the signed volume of the tetrahedron from the sphere's centre to a triangle,
// which is positive if the triangle faces outward. Before the moves, each child has a quarter of
// its parent's volume. A radial move of a corner multiplies the volume by a positive factor, which
// is at least 1 if the move leads outward.
struct PatchMarks {
  std::uint8_t* regular;  // by edge number of the parent: 0 or 1; null if no marks are kept
  const std::uint8_t* parent_safe;  // bit t % 4 of byte t / 4: whether parent triangle t is safe
  std::uint8_t* child_safe;  // bit k of byte t: whether child k of parent t is safe; null: not kept
  std::uint32_t* list;       // the parents whose patches must be tested, in any order
  unsigned long long* listed;  // their number

  __device__ bool is_safe(std::uint64_t t) const {
    return (parent_safe[t / 4] >> (t % 4) & 1) != 0;
  }
};

// Level 1 and above: the midpoints are handled, and a patch is a parent triangle with its three
// midpoints and its four children. `parent` is the mesh before the subdivision, `mesh` the one
// after it. They share the vertex arrays: the parent's vertices stand in front, then the midpoints
// by edge number.
struct MidpointLevel {
  static constexpr int kVertices = 6, kTriangles = 4;  // per patch
  DeviceMeshView parent, mesh;
  EdgeNumbersView edges;  // of the parent
  PatchMarks marks;
  bool is_first;  // whether this is level 1, whose edges are the longest

  __host__ __device__ std::uint64_t patches() const { return parent.triangles; }
  // Corner k of a child, as an index i into the patch's vertices (see vertex()).
  __device__ int corner(int child, int k) const { return child_corner(child, k); }
  // The midpoint on the parent's half-edge h, as a vertex of `mesh`. The lower half-edge of an edge
  // has the edge's number.
  __device__ std::uint32_t midpoint_of(std::uint64_t h) const {
    const std::uint64_t opposite = parent.opposite[h];
    return static_cast<std::uint32_t>(parent.vertices + edges.number(opposite < h ? opposite : h));
  }
  // Vertex i of patch t: a corner of parent triangle t for i < 3, else the midpoint of its
  // half-edge 3t + i - 3.
  __device__ std::uint32_t vertex(std::uint64_t t, int i) const {
    return i < 3 ? parent.corners[3 * t + i] : midpoint_of(3 * t + i - 3);
  }
  // The vertices at the two ends of half-edge h.
  __device__ std::uint32_t start_of(std::uint64_t h) const { return parent.corners[h]; }
  __device__ std::uint32_t end_of(std::uint64_t h) const {
    return parent.corners[h % 3 == 2 ? h - 2 : h + 1];
  }
  // The middle of half-edge h, from which its midpoint is projected.
  __device__ Vec3d middle_of(std::uint64_t h) const {
    return midpoint(parent.positions[start_of(h)], parent.positions[end_of(h)]);
  }
  // The position of vertex i of patch t before its move.
  __device__ Vec3d before(std::uint64_t t, int i) const {
    return i < 3 ? parent.positions[parent.corners[3 * t + i]] : middle_of(3 * t + i - 3);
  }
  // The label of a midpoint that stays on its edge: the atom of one of the edge's two ends, namely
  // the one whose sphere is nearer to the middle.
  __device__ VertexSpheres unprojected_label(const SurfaceView& surface, std::uint64_t h) const {
    const SphereId a = parent.vertex_spheres.atoms[start_of(h)];
    const SphereId b = parent.vertex_spheres.atoms[end_of(h)];
    return on_sphere(nearer_sphere(surface.spheres, a, b, middle_of(h)));
  }
  // Puts vertex v, the midpoint of half-edge h, into the middle of its edge.
  __device__ void take_back(const SurfaceView& surface, std::uint64_t h, std::uint32_t v) const {
    mesh.positions[v] = middle_of(h);
    mesh.vertex_spheres.set(v, unprojected_label(surface, h));
  }
};

}  // namespace vdwmesh
