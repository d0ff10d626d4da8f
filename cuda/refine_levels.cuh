// A level of a refinement as its kernels see it, and the counts that they add to.
#pragma once

#include <cstdint>

#include "cuda/device_structures.cuh"
#include "refine/surface_view.hpp"

namespace vdwmesh {

// ProjectionStats as kernels add to them. Residuals are not negative, so their bits order as they
// do.
struct DeviceStats {
  unsigned long long projected, unconverged, out_of_reach, turned, residual_bits;
  int iterations_max;
};

// Adds the warp's outcomes with one atomic operation each.
__device__ inline void count_outcome(const ProjectedPoint& p, bool counts, DeviceStats* stats) {
  const unsigned lanes = __activemask();
  const auto count = [&](ProjectionOutcome outcome, unsigned long long* slot) {
    const unsigned votes = __ballot_sync(lanes, counts && p.outcome == outcome);
    if (votes != 0 &&
        (threadIdx.x % 32) == static_cast<unsigned>(__ffs(static_cast<int>(votes)) - 1)) {
      atomicAdd(slot, static_cast<unsigned long long>(__popc(votes)));
    }
  };
  count(ProjectionOutcome::converged, &stats->projected);
  count(ProjectionOutcome::unconverged, &stats->unconverged);
  count(ProjectionOutcome::out_of_reach, &stats->out_of_reach);
  const int steps = __reduce_max_sync(lanes, counts ? p.steps : 0);
  const bool leader =
      (threadIdx.x % 32) == static_cast<unsigned>(__ffs(static_cast<int>(lanes)) - 1);
  if (leader && steps > stats->iterations_max) atomicMax(&stats->iterations_max, steps);
  if (counts && p.outcome == ProjectionOutcome::converged) {
    const auto bits = static_cast<unsigned long long>(__double_as_longlong(p.residual));
    if (bits > stats->residual_bits) atomicMax(&stats->residual_bits, bits);
  }
}

__device__ inline VertexSpheres make_label(const SphereId* s) { return {s[0], s[1], s[2]}; }
__device__ inline const SphereId* ids(const VertexSpheres& label) {
  return reinterpret_cast<const SphereId*>(&label);
}

// A level as the kernels see it: patches of vertices with the triangles among them. Given: one
// triangle of three vertices, all of which the level handles.
struct GivenLevel {
  static constexpr int kVertices = 3, kTriangles = 1;
  DeviceMeshView given, mesh;

  __host__ __device__ std::uint64_t patches() const { return given.triangles; }
  __device__ int corner(int, int k) const { return k; }
  __device__ std::uint32_t vertex(std::uint64_t t, int i) const { return given.corners[3 * t + i]; }
  __device__ Vec3d before(std::uint64_t t, int i) const { return given.positions[vertex(t, i)]; }
  std::uint64_t first_handled() const { return 0; }
  std::uint64_t items() const { return given.vertices; }
  __device__ bool has_item(std::uint64_t) const { return true; }
  __device__ std::uint64_t handled_by_item(std::uint64_t item) const { return item; }
  __device__ void take_back(const SurfaceView&, std::uint64_t v) const {
    mesh.positions[v] = given.positions[v];
    mesh.vertex_spheres[v] = given.vertex_spheres[v];
  }
};

// Midpoints: a parent triangle, three old vertices and three midpoints, and its four children.
struct MidpointLevel {
  static constexpr int kVertices = 6, kTriangles = 4;
  DeviceMeshView parent, mesh;
  const std::uint32_t* edge;  // number of the edge of each half-edge of the parent

  __host__ __device__ std::uint64_t patches() const { return parent.triangles; }
  __device__ int corner(int child, int k) const { return child_corner(child, k); }
  __device__ std::uint32_t midpoint_of(std::uint64_t h) const {
    return static_cast<std::uint32_t>(parent.vertices + edge[h]);
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
  std::uint64_t first_handled() const { return parent.vertices; }
  std::uint64_t items() const { return 3 * parent.triangles; }
  __device__ bool has_item(std::uint64_t h) const { return parent.opposite[h] >= h; }
  __device__ std::uint64_t handled_by_item(std::uint64_t h) const { return edge[h]; }
  __device__ VertexSpheres unprojected_label(const SurfaceView& surface, std::uint64_t h) const {
    const SphereId a = ids(parent.vertex_spheres[start_of(h)])[0];
    const SphereId b = ids(parent.vertex_spheres[end_of(h)])[0];
    return on_sphere(nearer_sphere(surface.spheres, a, b, start(h)));
  }
  __device__ void take_back(const SurfaceView& surface, std::uint64_t h) const {
    const std::uint32_t v = midpoint_of(h);
    mesh.positions[v] = start(h);
    mesh.vertex_spheres[v] = unprojected_label(surface, h);
  }
};

}  // namespace vdwmesh
