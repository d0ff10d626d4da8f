// The Extractor on the CPU: a descent through blocks of bricks finds the candidates
// (brick_search.hpp), and marching cubes runs over them (bricks/brick_mesher.hpp) with the
// signs and vertices of the field's kind.
#include <vector>

#include "core/lanes/multiversion.hpp"
#include "core/workspace.hpp"
#include "extract/blended/blended_brick.hpp"
#include "extract/brick_search.hpp"
#include "extract/bricks/brick_mesher.hpp"
#include "extract/count_part.hpp"
#include "extract/extractor.hpp"
#include "extract/field_kinds.hpp"
#include "extract/field_list.hpp"
#include "extract/part_without_halo.hpp"
#include "extract/union/union_brick.hpp"
#include "spheres/list_ids.hpp"

namespace vdwmesh {
namespace {

// What the loops of one extraction read. Each call of count() or emit() below makes a Surface of
// its own from it, so they can run on many threads.
struct BrickWork {
  const CellListView& list;
  const FieldModel& model;
};

using Keys = std::span<const std::uint64_t>;

// The Surface (brick_extraction.hpp) of a kind of field.
template <class Kind>
struct SurfaceOf {
  using type = BlendedBrick<Kind>;
};
template <>
struct SurfaceOf<UnionOfBalls> {
  using type = UnionBrick;
};

// ---- the loops of brick_extraction.hpp, compiled for two processor versions ----

template <class Kind>
VDWMESH_MULTIVERSION std::size_t count(const BrickWork& j, Keys keys, ActiveBrick* out) {
  typename SurfaceOf<Kind>::type surface(j.list, j.model);
  return count_bricks(surface, j.model.grid, keys, out);
}

template <class Kind>
VDWMESH_MULTIVERSION EmissionTally emit(const BrickWork& j, const Emission& e, std::size_t begin,
                                        std::size_t end) {
  typename SurfaceOf<Kind>::type surface(j.list, j.model);
  return emit_bricks(e, begin, end, surface);
}

BrickLoops loops_of(const BrickWork& job) {
  return with_kind(job.model.kind, [&]<class Kind>(Kind) {
    return BrickLoops{[job](Keys keys, ActiveBrick* out) { return count<Kind>(job, keys, out); },
                      [job](const Emission& e, std::size_t begin, std::size_t end) {
                        return emit<Kind>(job, e, begin, end);
                      }};
  });
}

// What an extraction needs: the field with its grid, and the cell list, which the workspace keeps.
struct ListedField {
  // `ids`: what labels call the spheres; empty: their indices.
  ListedField(const SphereSet& spheres, std::span<const SphereId> ids,
              const ExtractOptions& options, Workspace& workspace)
      : model(make_field_model(options.field, make_grid(spheres, options.grid))),
        list(field_list(spheres, model, options.frame, workspace)) {
    if (!ids.empty()) use_ids(ids, list, own_ids);
  }

  // A function that searches the bricks of the range when it is called. The ListedField must
  // outlive it. The largest number of bricks is that of which the ActiveBricks fit in the memory
  // limit.
  CandidateSearch candidates(const KeyRange& range, const ExtractOptions& options) const {
    return
        [this, range, most = options.memory_limit / sizeof(ActiveBrick),
         monitor = options.monitor] { return candidate_bricks(list, model, range, most, monitor); };
  }
  BrickWork job() const { return {list, model}; }

  FieldModel model;
  CellListView list;
  Buffer<SphereId> own_ids;  // of the list, if ids were given
};

// The most bricks that there are between the ends of a range and of its halo, which are a layer, a
// row and a brick apart. So many bricks are never counted, but room for them is not touched.
std::uint64_t most_behind(const GridSpec& grid) {
  const auto along = [](std::int64_t cells) {
    return static_cast<std::uint64_t>(brick_count(cells));
  };
  return along(grid.cells.x) * (along(grid.cells.y) + 1) + 1;
}

// Where the halo of a part comes from: it is counted with the part, or set_halo() gives it.
enum class HaloSource { counted, given };

// Only the bricks of the range are emitted.
class CpuSurfacePart final : public PartWithoutHalo {
 public:
  // `ids`: what labels call the spheres; empty: their indices.
  CpuSurfacePart(const SphereSet& spheres, std::span<const SphereId> ids, const KeyRange& range,
                 HaloSource halo, const ExtractOptions& options)
      : workspace_(options.workspace),
        scene_(spheres, ids, options, workspace_),
        mesher_(scene_.model.grid, loops_of(scene_.job()), LabelWidth::one, options, workspace_) {
    const bool is_given = halo == HaloSource::given;
    const KeyRange searched = is_given ? range : with_halo(range, options.connectivity);
    mesher_.count(scene_.candidates(searched, options), range,
                  is_given ? most_behind(scene_.model.grid) : 0);
  }

  MeshSize size() const override { return mesher_.size(); }
  HaloVertices halo() const override { return mesher_.halo(); }

  std::span<const ActiveBrick> counted(const KeyRange& wanted) const override {
    return mesher_.counted(wanted);
  }
  void set_halo(std::span<const std::vector<ActiveBrick>> parts) override {
    mesher_.set_halo(parts);
  }

  ExtractStats emit(const MeshSize& first, IndexedMesh& mesh) override {
    mesher_.emit(first, mesh);
    return mesher_.stats();
  }

 private:
  WorkspaceOfCall workspace_;
  ListedField scene_;
  BrickMesher mesher_;
};

class CpuExtractor final : public Extractor {
 public:
  void extract_into(ExtractResult& result, const SphereSet& spheres,
                    const ExtractOptions& options) const override {
    WorkspaceOfCall workspace(options.workspace);
    const ListedField scene(spheres, {}, options, workspace);
    // The range {} is all bricks.
    mesh_bricks(result, scene.model.grid, scene.candidates({}, options), loops_of(scene.job()),
                LabelWidth::one, options, workspace);
  }

  std::unique_ptr<SurfacePart> count(const SphereSet& spheres, const KeyRange& range,
                                     const ExtractOptions& options) const override {
    return count_part_on_cpu(spheres, {}, range, options);
  }
};

}  // namespace

std::unique_ptr<PartWithoutHalo> count_without_halo(const SphereSet& spheres,
                                                    std::span<const SphereId> ids,
                                                    const KeyRange& range,
                                                    const ExtractOptions& options) {
  ExtractOptions without_half_edges = options;
  without_half_edges.connectivity = Connectivity::triangles;
  return std::make_unique<CpuSurfacePart>(spheres, ids, range, HaloSource::given,
                                          without_half_edges);
}

std::unique_ptr<SurfacePart> count_part_on_cpu(const SphereSet& spheres,
                                               std::span<const SphereId> ids, const KeyRange& range,
                                               const ExtractOptions& options) {
  return std::make_unique<CpuSurfacePart>(spheres, ids, range, HaloSource::counted, options);
}

std::unique_ptr<Extractor> make_cpu_extractor() { return std::make_unique<CpuExtractor>(); }

}  // namespace vdwmesh
