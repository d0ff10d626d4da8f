// The excluded surfaces of a batch on a CUDA device: the grown balls are measured as those of any
// union, then ElementPipeline makes arcs, probes and patches, a thread for each.
//
// Corners are named by list places, whose order follows the cells; so arcs of a set stand together,
// and the corners of a set before those of the next only if places do: they do, because cells are
// numbered set by set.
#include <cuda_runtime.h>

#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "cuda/cuda_backend.hpp"
#include "cuda/excluded/device_executor.cuh"
#include "cuda/measure/device_measures.cuh"
#include "cuda/memory/device.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/transfer.cuh"
#include "excluded/elements/batch_rows.hpp"
#include "spheres/check_sphere.hpp"

namespace vdwmesh::excluded::elements {
namespace {

// What is no sphere becomes none, so that it is refused with its index.
struct GrowBalls {
  const Sphere* atoms;
  double probe;
  Sphere* grown;
  VDWMESH_HD void operator()(std::uint64_t i) const {
    const Sphere s = atoms[i];
    grown[i] = {s.center, is_sphere(s) ? s.radius + probe : -1.0};
  }
};

// Radii without the probe and measures of the grown balls, in the order of the list.
struct OrderByPlace {
  const std::uint32_t* id;
  const Sphere* atoms;
  const SphereMeasures* measures;
  double* radius;
  SphereMeasures* out;
  VDWMESH_HD void operator()(std::uint64_t place) const {
    radius[place] = atoms[id[place]].radius;
    out[place] = measures[id[place]];
  }
};

class CudaExcludedMeasurer final : public ExcludedMeasurer {
 public:
  void measure_into(ExcludedBatch& result, const SphereBatch& atoms, double probe,
                    Monitor* monitor) const override {
    check_sets(atoms);
    check_probe(probe);
    const DeviceScope scope;
    begin_stage(monitor, "excluded surface (CUDA)", 1);
    const Stream stream;
    result = {};
    if (atoms.memory == MemorySpace::host) {
      const DeviceArray<Sphere> uploaded(atoms.size, stream);
      upload_parts({{uploaded.data(), atoms.spheres, uploaded.bytes()}}, stream);
      measure(result, atoms, uploaded.data(), probe, stream, monitor);
    } else {
      std::vector<Sphere> host(atoms.size);
      download_parts({{host.data(), atoms.spheres, atoms.size * sizeof(Sphere)}}, stream);
      SphereBatch copy = atoms;
      copy.spheres = host.data();
      copy.memory = MemorySpace::host;
      measure(result, copy, atoms.spheres, probe, stream, monitor);
    }
    advance(monitor, 1);
  }

 private:
  // `atoms` are in memory of the host, `spheres` are the same on the device.
  static void measure(ExcludedBatch& result, const SphereBatch& atoms, const Sphere* spheres,
                      double probe, const Stream& stream, Monitor* monitor) {
    DeviceExecutor x(stream);
    DeviceArray<Sphere> grown = x.make<Sphere>(atoms.size);
    x.run("grow_balls", atoms.size, GrowBalls{spheres, probe, grown.data()});
    BatchMeasures unions;
    const measure::MeasuredBatch measured = measure::measure_batch(unions,
                                                                   {.spheres = grown.data(),
                                                                    .size = atoms.size,
                                                                    .offsets = atoms.offsets,
                                                                    .memory = MemorySpace::device},
                                                                   grown.data(), nullptr, stream);
    result.host_balls = measured.redone.size();
    const measure::BatchCellsView& list = measured.on_device.cells.view();
    // The device's rows, but for those that the host measured.
    const SphereMeasures* rows = measured.on_device.per_sphere.data();
    DeviceArray<SphereMeasures> replaced;
    if (!measured.redone.empty()) {
      replaced = x.upload(unions.per_sphere);
      rows = replaced.data();
    }
    DeviceArray<double> radius = x.make<double>(atoms.size);
    DeviceArray<SphereMeasures> by_place = x.make<SphereMeasures>(atoms.size);
    x.run("order_by_place", atoms.size,
          OrderByPlace{list.id.data(), spheres, rows, radius.data(), by_place.data()});
    const Balls balls{
        list.spheres.data(), radius.data(), by_place.data(), list.id.data(), list.set.data(),
        list.size,           probe};
    std::vector<Vec3d> home;
    for (std::size_t s = 0; s < atoms.set_count(); ++s) {
      home.push_back(atoms.spheres[atoms.set_begin(s)].center);
    }
    const OverlapLists<DeviceExecutor> near = x.overlaps(list, by_place.data());
    const std::vector<std::size_t> offsets = offsets_of(atoms);
    const ElementSums sums =
        ElementPipeline<DeviceExecutor>(x, balls, near, offsets, home).run(rows_of(result, atoms));
    sum_sets(result, atoms, probe, sums, unions.totals, monitor);
  }
};

}  // namespace
}  // namespace vdwmesh::excluded::elements

namespace vdwmesh {

std::unique_ptr<ExcludedMeasurer> make_cuda_excluded_measurer() {
  return std::make_unique<excluded::elements::CudaExcludedMeasurer>();
}

}  // namespace vdwmesh
