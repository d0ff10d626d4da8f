// Distances between meshes and unions of balls on the CPU or on a CUDA device.
//
// make_distance_measurer() (cuda/backend.hpp) chooses the backend. Both give the same bits: they
// take the same samples, compute them by the same formulas, and add them up in the same order.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "analysis/distances.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class Monitor;

// What was measured, and why the CPU measured what was meant for a device; empty if it did not.
template <class Result>
struct MeasuredBy {
  Result result;
  std::string fallback;
};
using MeasuredDistances = MeasuredBy<MeshDistances>;
using MeasuredPoints = MeasuredBy<std::vector<double>>;

class DistanceMeasurer {
 public:
  virtual ~DistanceMeasurer() = default;
  // Does what distances() does, and throws DeviceMemoryExceeded as well.
  virtual MeasuredDistances measure(const IndexedMesh& mesh, const SphereSet& spheres,
                                    const DistanceOptions& options = {}) const = 0;
  // Does what signed_distances() does, and throws DeviceMemoryExceeded as well.
  virtual MeasuredPoints measure_points(std::span<const Vec3d> points, const SphereSet& spheres,
                                        Monitor* monitor = nullptr) const = 0;
};

// On all cores.
std::unique_ptr<DistanceMeasurer> make_cpu_distance_measurer();

}  // namespace vdwmesh
