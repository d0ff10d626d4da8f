// The measurer of the CPU: exact_union() by arcs for each set. One set is measured on all cores;
// many sets are measured side by side, a set for each task, with memory that each thread keeps.
#include "measures/union_measurer.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "core/errors.hpp"
#include "core/workspace.hpp"
#include "measures/many_unions.hpp"
#include "measures/total_measures.hpp"

namespace vdwmesh {
namespace {

// What a thread keeps from one set to the next.
struct UnionThread {
  Workspace workspace;
  ExactUnion measured;
};

class CpuUnionMeasurer final : public UnionMeasurer {
 public:
  void measure_into(BatchMeasures& result, const SphereBatch& batch,
                    Monitor* monitor) const override {
    if (batch.memory == MemorySpace::device) {
      throw InvalidInput("the spheres are in device memory: the CPU cannot measure them");
    }
    check_sets(batch);
    result.per_sphere.resize(batch.size);
    result.fallback.clear();
    if (batch.set_count() == 1) {
      measure_one(result, batch, monitor);
    } else {
      measure_many(result, batch, monitor);
    }
    sum_sets(result, batch);
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
