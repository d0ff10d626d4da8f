#include <vector>

#include "core/multiversion.hpp"
#include "extract/blended/blended_brick.hpp"
#include "extract/blended/field_sample.hpp"
#include "extract/brick_search.hpp"
#include "extract/bricks/brick_extraction.hpp"
#include "extract/extractor.hpp"
#include "extract/union/union_brick.hpp"

namespace vdwmesh {
namespace {

struct Job {
  const CellListView& list;
  const FieldModel& model;
};

using Keys = std::span<const std::uint64_t>;
using Blinn = BlendedBrick<FieldKind::blinn>;
using SoftObject = BlendedBrick<FieldKind::soft_object>;
using InverseSquared = BlendedBrick<FieldKind::inverse_squared>;

template <class Surface>
std::size_t count(const Job& j, Keys keys, ActiveBrick* out) {
  Surface surface(j.list, j.model);
  return count_bricks(surface, j.model.grid, keys, out);
}

template <class Surface>
EmissionTally emit(const Job& j, const Emission& e, std::size_t begin, std::size_t end) {
  Surface surface(j.list, j.model);
  return emit_bricks(e, begin, end, surface);
}

// ---- the loops in both processor versions ----

VDWMESH_MULTIVERSION std::size_t count_vdw(const Job& j, Keys keys, ActiveBrick* out) {
  return count<UnionBrick>(j, keys, out);
}
VDWMESH_MULTIVERSION std::size_t count_blinn(const Job& j, Keys keys, ActiveBrick* out) {
  return count<Blinn>(j, keys, out);
}
VDWMESH_MULTIVERSION std::size_t count_soft(const Job& j, Keys keys, ActiveBrick* out) {
  return count<SoftObject>(j, keys, out);
}
VDWMESH_MULTIVERSION std::size_t count_inverse(const Job& j, Keys keys, ActiveBrick* out) {
  return count<InverseSquared>(j, keys, out);
}
VDWMESH_MULTIVERSION EmissionTally emit_vdw(const Job& j, const Emission& e, std::size_t a,
                                            std::size_t b) {
  return emit<UnionBrick>(j, e, a, b);
}
VDWMESH_MULTIVERSION EmissionTally emit_blinn(const Job& j, const Emission& e, std::size_t a,
                                              std::size_t b) {
  return emit<Blinn>(j, e, a, b);
}
VDWMESH_MULTIVERSION EmissionTally emit_soft(const Job& j, const Emission& e, std::size_t a,
                                             std::size_t b) {
  return emit<SoftObject>(j, e, a, b);
}
VDWMESH_MULTIVERSION EmissionTally emit_inverse(const Job& j, const Emission& e, std::size_t a,
                                                std::size_t b) {
  return emit<InverseSquared>(j, e, a, b);
}

struct Kernels {
  std::size_t (*count)(const Job&, Keys, ActiveBrick*);
  EmissionTally (*emit)(const Job&, const Emission&, std::size_t, std::size_t);
};

Kernels kernels_of(FieldKind kind) {
  switch (kind) {
    case FieldKind::vdw:
      return {count_vdw, emit_vdw};
    case FieldKind::blinn:
      return {count_blinn, emit_blinn};
    case FieldKind::soft_object:
      return {count_soft, emit_soft};
    default:
      return {count_inverse, emit_inverse};
  }
}

class CpuExtractor final : public Extractor {
 public:
  ExtractResult extract(const SphereSet& spheres, const ExtractOptions& options) const override {
    const GridSpec grid = make_grid(spheres, options.grid);
    const FieldModel model = make_field_model(options.field, grid);
    const CellList list = make_field_list(spheres, model);
    const Job job{list.view(), model};
    const Kernels kernels = kernels_of(model.kind);
    const auto candidates = [&] {
      return candidate_bricks(list.view(), model, options.memory_limit / sizeof(ActiveBrick),
                              options.monitor);
    };
    const BrickLoops loops{
        [&](Keys keys, ActiveBrick* out) { return kernels.count(job, keys, out); },
        [&](const Emission& e, std::size_t begin, std::size_t end) {
          return kernels.emit(job, e, begin, end);
        }};
    return mesh_bricks(grid, candidates, loops, LabelWidth::one, options);
  }
};

}  // namespace

std::unique_ptr<Extractor> make_cpu_extractor() { return std::make_unique<CpuExtractor>(); }

}  // namespace vdwmesh
