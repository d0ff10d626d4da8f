// The CUDA backend of DistanceMeasurer. The host checks the arguments and finds the patches of the
// exposed surface while the device gets the mesh and builds the search tree over its triangles;
// then the device measures.
#include <future>
#include <optional>

#include "analysis/distance_measurer.hpp"
#include "cuda/cuda_backend.hpp"
#include "cuda/distances/device_tree.cuh"
#include "cuda/distances/measure_distances.cuh"
#include "cuda/memory/device.cuh"
#include "cuda/memory/run_on_threads.hpp"

namespace vdwmesh::distance {
namespace {

// The exposed surface and the search tree over its patches, in device memory.
class SearchedSurface {
 public:
  SearchedSurface(const ExposedSurface& surface, const Box& world, const Stream& stream)
      : patches_(surface, stream), tree_(patches_.balls(), patches_.size(), world, stream) {}
  const DeviceExposedPatches& patches() const { return patches_; }
  PatchTreeView view() const { return {patches_.patches(), patches_.balls(), tree_.view()}; }

 private:
  DeviceExposedPatches patches_;
  DeviceBoxTree tree_;
};

class CudaDistanceMeasurer final : public DistanceMeasurer {
 public:
  MeasuredDistances measure(const IndexedMesh& mesh, const SphereSet& spheres,
                            const DistanceOptions& options) const override {
    const DeviceScope scope;
    const Stream stream;
    std::optional<ExposedSurface> exposed;
    std::optional<DeviceSoup> soup;
    std::optional<DeviceBoxTree> triangles;
    std::packaged_task<DistancePlan()> make_plan(
        [&] { return plan_distances(mesh, spheres, options); });
    const std::shared_future<DistancePlan> planned = make_plan.get_future().share();
    // The mesh is copied before it is checked, but not used.
    const auto prepare_mesh = [&] {
      soup.emplace(mesh, stream);
      triangles.emplace(soup->view(), planned.get().world, stream);
    };
    const auto prepare_surface = [&] {
      make_plan();
      planned.get();  // throws what the plan has thrown
      exposed.emplace(spheres, options.monitor);
    };
    // The first piece of work stays on this thread, whose device is the current one.
    run_on_threads(2, [&](std::size_t k) { k == 0 ? prepare_mesh() : prepare_surface(); });
    const DistancePlan plan = planned.get();
    const SearchedSurface surface(*exposed, plan.world, stream);
    const DistanceStatistics of_mesh =
        mesh_to_surface(soup->view(), surface.view(), options, stream);
    // Most points of the surface are nearer to the mesh than four times the mean of the mesh's
    // distances.
    const double reach = 4 * of_mesh.mean;
    const DistanceStatistics of_surface =
        surface_to_mesh(surface.patches(), {soup->view(), triangles->view()}, plan.surface_density,
                        reach, options, stream);
    return {both_ways(of_mesh, of_surface, options.seed), {}};
  }

  MeasuredPoints measure_points(std::span<const Vec3d> points, const SphereSet& spheres,
                                Monitor* monitor) const override {
    check_points(points, spheres, "point");
    const Box world = box_around(bounding_box(spheres), points);
    const ExposedSurface exposed(spheres, monitor);
    const DeviceScope scope;
    const Stream stream;
    const SearchedSurface surface(exposed, world, stream);
    MeasuredPoints measured{std::vector<double>(points.size()), {}};
    points_to_surface(points, surface.view(), measured.result.data(), monitor, stream);
    return measured;
  }
};

}  // namespace
}  // namespace vdwmesh::distance

namespace vdwmesh {

std::unique_ptr<DistanceMeasurer> make_cuda_distance_measurer() {
  return std::make_unique<distance::CudaDistanceMeasurer>();
}

}  // namespace vdwmesh
