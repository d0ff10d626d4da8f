// Refinement of a mesh that lies in device memory. The CUDA Refiner calls it between an upload and
// a download; the CUDA pipeline calls it on the mesh that the extraction left on the device.
#pragma once

#include <vector>

#include "cuda/memory/device_structures.cuh"
#include "refine/surface_view.hpp"

namespace vdwmesh {

// Milliseconds of device time in the stages of one subdivision.
struct RefineTimings {
  float edges = 0;      // numbering edges, taking memory
  float midpoints = 0;  // their positions, labels and normals, with the projection
  float children = 0;   // corners and half-edges of the children, test of their orientation
  float moves = 0;      // search for crossings, taking bad moves back
};

struct DeviceRefinement {
  DeviceMesh mesh;
  std::vector<ProjectionStats> levels;    // as RefineResult::levels
  std::vector<float> level_milliseconds;  // level 0, each subdivision, the final normals
  std::vector<RefineTimings> timings;     // of each subdivision
};

// An estimate of the bytes of device memory that a refinement takes beside the mesh that it is
// given.
std::uint64_t device_refine_bytes(std::uint64_t vertices, std::uint64_t triangles,
                                  const RefineOptions& options, TriangleLabels labels);

// Refines `mesh` and consumes it. It takes the steps of the CPU refiner with the same formulas in
// the same order, so the result has the same bits. Precondition: `mesh` has half-edges if
// options.subdivisions > 0. Throws LimitExceeded before it takes memory.
DeviceRefinement refine_on_device(const SurfaceView& surface, DeviceMesh mesh,
                                  const RefineOptions& options, const Stream& stream);

// The surface that kernels project to, in device memory: the spheres, and the cell list that the
// projection searches. Must outlive the kernels that use its view.
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
