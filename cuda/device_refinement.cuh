// Refinement in device memory.
#pragma once

#include <vector>

#include "cuda/device_structures.cuh"
#include "refine/surface_view.hpp"

namespace vdwmesh {

struct DeviceRefinement {
  DeviceMesh mesh;
  std::vector<ProjectionStats> levels;
  std::vector<float> level_milliseconds;
};

// Refines in place of `mesh`, which must hold its half-edges; the steps of the CPU refiner on the
// same formulas, in the same order.
DeviceRefinement refine_on_device(const SurfaceView& surface, DeviceMesh mesh,
                                  const RefineOptions& options, const Stream& stream);

// What the kernels need beside the mesh: the spheres and the list of the projection.
class DeviceSurface {
 public:
  // Throws InvalidInput for options without sense.
  DeviceSurface(const SphereSet& spheres, const RefineOptions& options, TriangleLabels labels,
                const Stream& stream);
  const SurfaceView& view() const { return view_; }

 private:
  CellList host_list_;
  DeviceCellList list_;
  DeviceArray<Sphere> spheres_;
  SurfaceView view_{};
};

}  // namespace vdwmesh
