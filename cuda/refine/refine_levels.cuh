// A level of a refinement as its kernels see it, and the counts that they add to.
#pragma once

#include <cstdint>

#include "cuda/memory/device_structures.cuh"
#include "cuda/refine/edge_numbers.cuh"
#include "refine/level_view.hpp"
#include "refine/surface_view.hpp"

namespace vdwmesh {

__device__ inline std::uint64_t thread_index() {
  return static_cast<std::uint64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
}

// ProjectionStats as kernels add to them. Residuals are not negative, so their bits order as they
// do.
struct DeviceStats {
  unsigned long long projected, unconverged, out_of_reach, turned, residual_bits;
  int iterations_max;
};

// What a thread has seen of the outcomes, until its warp adds them up.
class OutcomeTally {
 public:
  __device__ void add(const ProjectedPoint& p) {
    converged_ += p.outcome == ProjectionOutcome::converged;
    unconverged_ += p.outcome == ProjectionOutcome::unconverged;
    out_of_reach_ += p.outcome == ProjectionOutcome::out_of_reach;
    if (p.steps > steps_) steps_ = p.steps;
    if (p.outcome == ProjectionOutcome::converged && p.residual > residual_) residual_ = p.residual;
  }

  // Called by all lanes of the warp, once.
  __device__ void add_to(DeviceStats* stats) const {
    constexpr unsigned all = 0xffffffffu;
    const unsigned converged = __reduce_add_sync(all, converged_);
    const unsigned unconverged = __reduce_add_sync(all, unconverged_);
    const unsigned out_of_reach = __reduce_add_sync(all, out_of_reach_);
    const int steps = __reduce_max_sync(all, steps_);
    double residual = residual_;
    for (int step = 16; step > 0; step /= 2) {
      const double other = __shfl_xor_sync(all, residual, step);
      if (other > residual) residual = other;
    }
    if (threadIdx.x % 32 != 0) return;
    if (converged > 0) atomicAdd(&stats->projected, converged);
    if (unconverged > 0) atomicAdd(&stats->unconverged, unconverged);
    if (out_of_reach > 0) atomicAdd(&stats->out_of_reach, out_of_reach);
    if (steps > stats->iterations_max) atomicMax(&stats->iterations_max, steps);
    const auto bits = static_cast<unsigned long long>(__double_as_longlong(residual));
    if (bits > stats->residual_bits) atomicMax(&stats->residual_bits, bits);
  }

 private:
  unsigned converged_ = 0, unconverged_ = 0, out_of_reach_ = 0;
  int steps_ = 0;
  double residual_ = 0;
};

// What became of the vertices that a level handles, which are the last of its mesh. Other threads
// may be marking them at the same time.
struct FatesView {
  Fate* fates;  // in an array of fate_bytes()
  std::uint64_t first_handled;
  unsigned long long* marked;  // grows by one for each vertex that is marked
  std::uint32_t* list;         // their numbers among the handled ones, as far as there is room
  std::uint64_t room;

  __device__ Fate of(std::uint32_t v) const {
    if (v < first_handled) return Fate::stayed;
    return *const_cast<const volatile Fate*>(&fates[v - first_handled]);
  }
  __device__ void mark(std::uint32_t v) const {
    if (of(v) != Fate::moved) return;
    const std::uint64_t i = v - first_handled;
    auto* const word = reinterpret_cast<unsigned*>(fates) + i / 4;
    const unsigned shift = 8 * static_cast<unsigned>(i % 4);
    const auto fate_in = [=](unsigned bits) { return static_cast<Fate>(bits >> shift & 0xff); };
    for (unsigned seen = *const_cast<volatile unsigned*>(word);;) {
      if (fate_in(seen) != Fate::moved) return;
      const unsigned marks = static_cast<unsigned>(Fate::taking_back) << shift;
      const unsigned old = atomicCAS(word, seen, (seen & ~(0xffu << shift)) | marks);
      if (old == seen) break;
      seen = old;
    }
    const unsigned long long slot = atomicAdd(marked, 1ull);
    if (slot < room) list[slot] = static_cast<std::uint32_t>(i);
  }
};

// Fates are exchanged in words of four.
inline std::uint64_t fate_bytes(std::uint64_t handled) { return (handled + 3) / 4 * 4; }

__device__ inline VertexSpheres make_label(const SphereId* s) { return {s[0], s[1], s[2]}; }

// A level as the kernels see it: patches of vertices with the triangles among them. Given: one
// triangle of three vertices, all of which the level handles.
struct GivenLevel {
  static constexpr int kVertices = 3, kTriangles = 1;
  DeviceMeshView given, mesh;

  __host__ __device__ std::uint64_t patches() const { return given.triangles; }
  __device__ int corner(int, int k) const { return k; }
  __device__ std::uint32_t vertex(std::uint64_t t, int i) const { return given.corners[3 * t + i]; }
  __device__ Vec3d before(std::uint64_t t, int i) const { return given.positions[vertex(t, i)]; }
  __device__ void take_back(const SurfaceView& surface, std::uint64_t v) const {
    mesh.positions[v] = given.positions[v];
    const VertexSpheres label = given.vertex_spheres[v];
    mesh.vertex_spheres.set(v, label);
    if (mesh.normals != nullptr) {
      mesh.normals[v] = surface.normal(mesh.positions[v], ids(label));
    }
  }
};

// What spares most triangles a look at their places. A midpoint is regular when it went radially to
// the sphere of both ends. A triangle is safe when it is of one atom and faces outward by a wide
// margin (is_safe()). Moving points radially from a centre keeps the sign of the volume that they
// span with it, and a child spans a quarter of its parent's at least: the children of a safe
// triangle with regular midpoints face outward and are safe.
struct PatchMarks {
  std::uint8_t* regular;            // by edge; null: nothing is known
  const std::uint8_t* parent_safe;  // bit t % 4 of byte t / 4
  std::uint8_t* child_safe;         // the same of the children: by parent; null on the last level
  std::uint32_t* list;              // patches that must be looked at
  unsigned long long* listed;

  __device__ bool is_safe(std::uint64_t t) const {
    return (parent_safe[t / 4] >> (t % 4) & 1) != 0;
  }
};

// Midpoints: a parent triangle, three old vertices and three midpoints, and its four children.
// `mesh` holds the parent's vertices in front.
struct MidpointLevel {
  static constexpr int kVertices = 6, kTriangles = 4;
  DeviceMeshView parent, mesh;
  EdgeNumbersView edges;
  PatchMarks marks;
  bool is_first;  // of its refinement: its edges are long

  __host__ __device__ std::uint64_t patches() const { return parent.triangles; }
  __device__ int corner(int child, int k) const { return child_corner(child, k); }
  __device__ std::uint32_t midpoint_of(std::uint64_t h) const {
    const std::uint64_t opposite = parent.opposite[h];
    return static_cast<std::uint32_t>(parent.vertices + edges.number(opposite < h ? opposite : h));
  }
  __device__ std::uint32_t vertex(std::uint64_t t, int i) const {
    return i < 3 ? parent.corners[3 * t + i] : midpoint_of(3 * t + i - 3);
  }
  __device__ std::uint32_t start_of(std::uint64_t h) const { return parent.corners[h]; }
  __device__ std::uint32_t end_of(std::uint64_t h) const {
    return parent.corners[h % 3 == 2 ? h - 2 : h + 1];
  }
  __device__ Vec3d start(std::uint64_t h) const {
    return midpoint(parent.positions[start_of(h)], parent.positions[end_of(h)]);
  }
  __device__ Vec3d before(std::uint64_t t, int i) const {
    return i < 3 ? parent.positions[parent.corners[3 * t + i]] : start(3 * t + i - 3);
  }
  __device__ VertexSpheres unprojected_label(const SurfaceView& surface, std::uint64_t h) const {
    const SphereId a = parent.vertex_spheres.atoms[start_of(h)];
    const SphereId b = parent.vertex_spheres.atoms[end_of(h)];
    return on_sphere(nearer_sphere(surface.spheres, a, b, start(h)));
  }
  // Vertex v, the midpoint of h, goes back to the middle of its edge.
  __device__ void take_back(const SurfaceView& surface, std::uint64_t h, std::uint32_t v) const {
    mesh.positions[v] = start(h);
    mesh.vertex_spheres.set(v, unprojected_label(surface, h));
  }
};

}  // namespace vdwmesh
