#include <vector>

#include "core/multiversion.hpp"
#include "extract/blended/blended_brick.hpp"
#include "extract/blended/field_sample.hpp"
#include "extract/brick_search.hpp"
#include "extract/bricks/brick_extraction.hpp"
#include "extract/extractor.hpp"
#include "extract/field_kinds.hpp"
#include "extract/union/union_brick.hpp"

namespace vdwmesh {
namespace {

struct Job {
  const CellListView& list;
  const FieldModel& model;
};

using Keys = std::span<const std::uint64_t>;

// The surface of a kind, seen from one brick.
template <class Kind>
struct SurfaceOf {
  using type = BlendedBrick<Kind>;
};
template <>
struct SurfaceOf<UnionOfBalls> {
  using type = UnionBrick;
};

// ---- the loops in both processor versions ----

template <class Kind>
VDWMESH_MULTIVERSION std::size_t count(const Job& j, Keys keys, ActiveBrick* out) {
  typename SurfaceOf<Kind>::type surface(j.list, j.model);
  return count_bricks(surface, j.model.grid, keys, out);
}

template <class Kind>
VDWMESH_MULTIVERSION EmissionTally emit(const Job& j, const Emission& e, std::size_t begin,
                                        std::size_t end) {
  typename SurfaceOf<Kind>::type surface(j.list, j.model);
  return emit_bricks(e, begin, end, surface);
}

BrickLoops loops_of(const Job& job) {
  return with_kind(job.model.kind, [&]<class Kind>(Kind) {
    return BrickLoops{[job](Keys keys, ActiveBrick* out) { return count<Kind>(job, keys, out); },
                      [job](const Emission& e, std::size_t begin, std::size_t end) {
                        return emit<Kind>(job, e, begin, end);
                      }};
  });
}

class CpuExtractor final : public Extractor {
 public:
  ExtractResult extract(const SphereSet& spheres, const ExtractOptions& options) const override {
    const GridSpec grid = make_grid(spheres, options.grid);
    const FieldModel model = make_field_model(options.field, grid);
    const CellList list = make_field_list(spheres, model);
    const Job job{list.view(), model};
    const auto candidates = [&] {
      return candidate_bricks(list.view(), model, options.memory_limit / sizeof(ActiveBrick),
                              options.monitor);
    };
    return mesh_bricks(grid, candidates, loops_of(job), LabelWidth::one, options);
  }
};

}  // namespace

std::unique_ptr<Extractor> make_cpu_extractor() { return std::make_unique<CpuExtractor>(); }

}  // namespace vdwmesh
