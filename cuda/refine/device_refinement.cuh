// Refinement of a mesh that is in device memory. The CUDA Refiner calls it between an upload and a
// download; the CUDA pipeline calls it on the mesh that the extraction left on the device.
#pragma once

#include <vector>

#include "cuda/memory/device_structures.cuh"
#include "cuda/spheres/device_frames.cuh"
#include "refine/surface_view.hpp"

namespace vdwmesh {

// Milliseconds of device time in the stages of one subdivision.
struct RefineTimings {
  float edges = 0;      // numbering the edges, taking memory
  float midpoints = 0;  // positions, labels and normals of midpoints, with the projection
  float children = 0;   // corners and half-edges of children, test of their orientation
  float moves = 0;      // search for crossings, taking bad moves back
};

// How many pairs of patches, and of their quarters, the search for crossings lists at a time: 256
// MB of each. The results do not depend on it.
inline constexpr std::uint64_t kPairsAtOnce = std::uint64_t{1} << 25;

struct DeviceRefinement {
  DeviceMesh mesh;
  std::vector<ProjectionStats> levels;    // of level 0 and of each subdivision
  std::vector<float> level_milliseconds;  // level 0, each subdivision, the final normals
  std::vector<RefineTimings> timings;     // of each subdivision
};

// An estimate of the bytes of device memory that a refinement takes, beside the given mesh of so
// many vertices and triangles.
std::uint64_t device_refine_bytes(std::uint64_t vertices, std::uint64_t triangles,
                                  const RefineOptions& options, TriangleLabels labels,
                                  std::uint64_t pairs_at_once = kPairsAtOnce);

// Refines `mesh`, whose arrays it takes over. It takes the steps of the CPU refiner with the same
// formulas in the same order, so the result has the same bits. Half-edges are found here if they
// are needed and missing. Throws InvalidInput if the mesh is not closed then, and
// DeviceMemoryExceeded, before it takes memory if the estimate of device_refine_bytes() is not
// available or allowed.
DeviceRefinement refine_on_device(const SurfaceView& surface, DeviceMesh mesh,
                                  const RefineOptions& options, const Stream& stream,
                                  std::uint64_t pairs_at_once = kPairsAtOnce);

// Owns the surface that kernels project to, in device memory: the spheres, and the cell list that
// the projection searches. It must outlive the kernels that use its view.
class DeviceSurface {
 public:
  // Throws InvalidInput for invalid options.
  DeviceSurface(const SphereSet& spheres, const RefineOptions& options, TriangleLabels labels,
                Workspace& workspace, const Stream& stream);
  // The same for the balls of the first frame in device memory, at which the surface looks.
  DeviceSurface(const DeviceFrames::Data& balls, const RefineOptions& options,
                TriangleLabels labels);
  const SurfaceView& view() const { return view_; }

 private:
  DeviceCellList list_;
  DeviceArray<Sphere> spheres_;
  SurfaceView view_{};
};

}  // namespace vdwmesh
