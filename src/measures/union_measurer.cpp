// The measurer of the CPU: exact_union() by arcs, or union_gradients(), for each set. One set is
// measured on all cores; many sets are measured side by side, a set for each task, with memory that
// each thread keeps.
#include "measures/union_measurer.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "core/errors.hpp"
#include "core/workspace.hpp"
#include "measures/arcs/ball_gradient.hpp"
#include "measures/many_unions.hpp"
#include "measures/total_measures.hpp"

namespace vdwmesh {
namespace {

// What a thread keeps from one set to the next.
struct UnionThread {
  Workspace workspace;
  ExactUnion measured;
  UnionGradients gradients;
};

void check_on_host(const SphereBatch& batch) {
  if (batch.memory == MemorySpace::device) {
    throw InvalidInput("the spheres are in device memory: the CPU cannot measure them");
  }
  check_sets(batch);
}

// The weights of `size` spheres from `first` on.
std::span<const double> weights_from(const double* weights, std::size_t first, std::size_t size) {
  return weights == nullptr ? std::span<const double>() : std::span(weights + first, size);
}

class CpuUnionMeasurer final : public UnionMeasurer {
 public:
  void measure_into(BatchMeasures& result, const SphereBatch& batch,
                    Monitor* monitor) const override {
    check_on_host(batch);
    result.per_sphere.resize(batch.size);
    result.fallback.clear();
    if (batch.set_count() == 1) {
      measure_one(result, batch, monitor);
    } else {
      measure_many(result, batch, monitor);
    }
    sum_sets(result, batch);
  }

  void gradients_into(BatchGradients& result, const SphereBatch& batch, const BatchWeights& weights,
                      Monitor* monitor) const override {
    check_on_host(batch);
    SphereSet::view({batch.spheres, batch.size});  // errors name the index in the batch
    check_weights(weights_from(weights.area, 0, batch.size),
                  weights_from(weights.volume, 0, batch.size), batch.size);
    BatchMeasures& measures = result.measures;
    measures.per_sphere.resize(batch.size);
    measures.fallback.clear();
    result.per_sphere.resize(batch.size);
    result.kink_spheres.resize(batch.set_count());
    std::atomic<std::uint64_t> fallback_spheres{0};
    for_each_union<UnionThread>(
        batch.set_count(), monitor, [&](std::size_t set, UnionThread& space, Monitor* inside) {
          const std::size_t first = batch.set_begin(set), size = batch.set_end(set) - first;
          UnionGradients& found = space.gradients;
          union_gradients_into(found, SphereSet::view({batch.spheres + first, size}),
                               {.area_weights = weights_from(weights.area, first, size),
                                .volume_weights = weights_from(weights.volume, first, size),
                                .monitor = inside,
                                .workspace = &space.workspace});
          std::ranges::copy(found.per_sphere, measures.per_sphere.begin() + first);
          std::ranges::copy(found.gradients, result.per_sphere.begin() + first);
          fallback_spheres += found.fallback_spheres;
          result.kink_spheres[set] = found.kink_spheres;
        });
    measures.fallback_spheres = fallback_spheres;
    sum_sets(measures, batch);
  }

 private:
  static void measure_one(BatchMeasures& result, const SphereBatch& batch, Monitor* monitor) {
    ExactUnion measured;
    std::swap(measured.per_sphere, result.per_sphere);  // to reuse its memory
    exact_union_into(measured, SphereSet::view({batch.spheres, batch.size}),
                     {.method = UnionMethod::arcs, .monitor = monitor});
    std::swap(measured.per_sphere, result.per_sphere);
    result.fallback_spheres = measured.fallback_spheres;
  }

  // All spheres are checked first, so that an error names the index in the batch and not in a set.
  static void measure_many(BatchMeasures& result, const SphereBatch& batch, Monitor* monitor) {
    SphereSet::view({batch.spheres, batch.size});
    std::atomic<std::uint64_t> fallback_spheres{0};
    for_each_union<UnionThread>(
        batch.set_count(), monitor, [&](std::size_t set, UnionThread& space, Monitor* inside) {
          const std::size_t first = batch.set_begin(set), size = batch.set_end(set) - first;
          exact_union_into(
              space.measured, SphereSet::view({batch.spheres + first, size}),
              {.method = UnionMethod::arcs, .monitor = inside, .workspace = &space.workspace});
          std::ranges::copy(space.measured.per_sphere, result.per_sphere.begin() + first);
          fallback_spheres += space.measured.fallback_spheres;
        });
    result.fallback_spheres = fallback_spheres;
  }
};

}  // namespace

void sum_sets(BatchMeasures& result, const SphereBatch& batch) {
  result.totals.resize(batch.set_count());
  tbb::parallel_for(std::size_t{0}, batch.set_count(), [&](std::size_t set) {
    const std::size_t first = batch.set_begin(set);
    result.totals[set] =
        total_measures({result.per_sphere.data() + first, batch.set_end(set) - first});
  });
}

std::unique_ptr<UnionMeasurer> make_cpu_union_measurer() {
  return std::make_unique<CpuUnionMeasurer>();
}

}  // namespace vdwmesh
