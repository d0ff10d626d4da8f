// Refinement in device memory.
#pragma once

#include <vector>

#include "cuda/memory/device_structures.cuh"
#include "refine/surface_view.hpp"

namespace vdwmesh {

// What the kernels of a subdivision took, ms.
struct RefineTimings {
  float edges = 0;      // numbers of edges, memory
  float midpoints = 0;  // positions, labels, normals, projected
  float children = 0;   // corners and half-edges, turned triangles
  float moves = 0;      // those taken back; crossings
};

struct DeviceRefinement {
  DeviceMesh mesh;
  std::vector<ProjectionStats> levels;
  std::vector<float> level_milliseconds;
  std::vector<RefineTimings> timings;  // of each subdivision
};

// Bytes of device memory that a refinement takes beside the mesh that it is given.
std::uint64_t device_refine_bytes(std::uint64_t vertices, std::uint64_t triangles,
                                  const RefineOptions& options, TriangleLabels labels);

// Refines in place of `mesh`, which must hold its half-edges; the steps of the CPU refiner on the
// same formulas, in the same order. Throws LimitExceeded before it takes memory.
DeviceRefinement refine_on_device(const SurfaceView& surface, DeviceMesh mesh,
                                  const RefineOptions& options, const Stream& stream);

// What the kernels need beside the mesh: the spheres and the list of the projection.
class DeviceSurface {
 public:
  // Throws InvalidInput for options without sense.
  DeviceSurface(const SphereSet& spheres, const RefineOptions& options, TriangleLabels labels,
                Workspace& workspace, const Stream& stream);
  const SurfaceView& view() const { return view_; }

 private:
  DeviceCellList list_;
  DeviceArray<Sphere> spheres_;
  SurfaceView view_{};
};

}  // namespace vdwmesh
