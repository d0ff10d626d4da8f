// The CPU backend of DistanceMeasurer: the functions of distances.hpp and signed_distance.hpp.
#include "analysis/distance_measurer.hpp"

#include "analysis/signed_distance.hpp"

namespace vdwmesh {
namespace {

class CpuDistanceMeasurer final : public DistanceMeasurer {
 public:
  MeasuredDistances measure(const IndexedMesh& mesh, const SphereSet& spheres,
                            const DistanceOptions& options) const override {
    return {distances(mesh, spheres, options), {}};
  }
  MeasuredPoints measure_points(std::span<const Vec3d> points, const SphereSet& spheres,
                                Monitor* monitor) const override {
    return {signed_distances(points, spheres, monitor), {}};
  }
};

}  // namespace

std::unique_ptr<DistanceMeasurer> make_cpu_distance_measurer() {
  return std::make_unique<CpuDistanceMeasurer>();
}

}  // namespace vdwmesh
