// FieldMesher on the CPU. Sampling visits all bricks, rows along x in parallel, and stores the
// values that the Extractor would compute in them. Meshing is marching cubes over all bricks
// (bricks/brick_mesher.hpp) with signs and vertices from the stored values instead of the
// spheres.
#include "extract/sampled_field.hpp"

#include <tbb/parallel_for.h>

#include "core/multiversion.hpp"
#include "extract/blended/blended_brick.hpp"
#include "extract/blended/sampled_formulas.hpp"
#include "extract/bricks/brick_mesher.hpp"
#include "extract/field_kinds.hpp"
#include "extract/field_list.hpp"
#include "extract/limits.hpp"

namespace vdwmesh {
namespace {

using Keys = std::span<const std::uint64_t>;

// ---- sampling ----

// The row of bricks along x with these indices along y and z.
struct BrickRow {
  std::int32_t y, z;
};

// Input and output of the sampling; `values` are those of the SampledField.
struct Sampling {
  const CellListView& list;
  const FieldModel& model;
  float* values;
};

// Writes the values of the nodes that the brick owns and that belong to the grid.
void store(const BrickValues& field, const BrickGeometry& g, const Sampling& s) {
  const GridSpec& grid = s.model.grid;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      if ((g.real[1] >> y & g.real[2] >> z & 1) == 0) continue;
      for (int x = 0; x < kBrickSide; ++x) {
        if ((g.real[0] >> x & 1) == 0) continue;
        const int node[3] = {x, y, z};
        const SampledFieldView view{grid, s.values, 0};
        s.values[node_address(view, lattice_node(g.brick, node)) - view.values] =
            field.row[z][y][x];
      }
    }
  }
}

// Samples one row of bricks; VDWMESH_MULTIVERSION compiles it for two processor versions.
template <BlendedKind Kind>
VDWMESH_MULTIVERSION void sample_row(const Sampling& s, const BrickRow& row) {
  BlendedBrick<Kind> surface(s.list, s.model);
  BrickValues field;
  for (std::int32_t x = 0; x < brick_count(s.model.grid.cells.x); ++x) {
    const BrickIndex brick{x, row.y, row.z};
    surface.visit(brick);
    surface.values(field);
    store(field, brick_geometry(s.model.grid, brick), s);
  }
}

// The Surface (brick_extraction.hpp) of a sampled field.
class SampledBrick {
 public:
  explicit SampledBrick(const SampledFieldView& field) : field_(field) {}

  void visit(const BrickIndex& brick) { geometry_ = brick_geometry(field_.grid, brick); }

  void signs(BrickSigns& signs) const {
    signs = {};
    for (int z = 0; z < kBrickReach; ++z) {
      for (int y = 0; y < kBrickReach; ++y) {
        if ((geometry_.real[1] >> y & geometry_.real[2] >> z & 1) == 0) continue;
        const int node[3] = {0, y, z};
        // Where the value of the row's node 0 would be. This node may be virtual; only the values
        // of nodes that belong to the grid are read.
        const float* const row = node_address(field_, lattice_node(geometry_.brick, node));
        signs.row[z][y] = static_cast<std::uint16_t>(
            geometry_.real[0] == kWholeRow ? whole_row_signs(row) : row_signs(row));
      }
    }
  }

  // Calls put(i, vertex) for every edge i of `edges`, which are the brick's crossed edges.
  template <class Put>
  void vertices(const BrickEdges& edges, Put&& put) const {
    for (std::size_t i = 0; i < edges.all().size(); ++i) put(i, vertex(edges.all()[i].crossed()));
  }

 private:
  // All nodes of a row belong to the grid, as in all bricks but the last ones.
  static constexpr std::uint32_t kWholeRow = (1u << kBrickReach) - 1;

  // Bit x: whether node x of the row is inside. Without a branch in it, the compiler makes one
  // comparison of eight values of the loop, in which this is most of the time of a field in memory.
  std::uint32_t whole_row_signs(const float* row) const {
    std::uint32_t bits = 0;
    for (int x = 0; x < kBrickReach; ++x) bits |= std::uint32_t{row[x] >= field_.isovalue} << x;
    return bits;
  }
  // The same for a row that ends before its last node.
  std::uint32_t row_signs(const float* row) const {
    std::uint32_t bits = 0;
    for (int x = 0; x < kBrickReach; ++x) {
      if ((geometry_.real[0] >> x & 1) != 0 && row[x] >= field_.isovalue) bits |= 1u << x;
    }
    return bits;
  }

  EdgeVertex vertex(const CrossedEdge& edge) const {
    const Vec3d node = geometry_.node(edge.inside[0], edge.inside[1], edge.inside[2]);
    EdgeVertex v =
        sampled_vertex(field_, sampled_values(field_, geometry_.brick, edge), edge, node);
    v.normal = sampled_normal(field_, geometry_.brick, edge, v);
    return v;
  }

  const SampledFieldView& field_;
  BrickGeometry geometry_{};
};

VDWMESH_MULTIVERSION std::size_t count_sampled(const SampledFieldView& field, Keys keys,
                                               ActiveBrick* out) {
  SampledBrick surface(field);
  return count_bricks(surface, field.grid, keys, out);
}

VDWMESH_MULTIVERSION EmissionTally emit_sampled(const SampledFieldView& field, const Emission& e,
                                                std::size_t begin, std::size_t end) {
  SampledBrick surface(field);
  return emit_bricks(e, begin, end, surface);
}

// The keys of all bricks of the grid, rising. A sampled field has no bounds to search with.
std::vector<std::uint64_t> all_bricks(const GridSpec& grid) {
  std::vector<std::uint64_t> keys;
  for (std::int32_t z = 0; z < brick_count(grid.cells.z); ++z) {
    for (std::int32_t y = 0; y < brick_count(grid.cells.y); ++y) {
      for (std::int32_t x = 0; x < brick_count(grid.cells.x); ++x) {
        keys.push_back(brick_key({x, y, z}));
      }
    }
  }
  return keys;
}

class CpuFieldMesher final : public FieldMesher {
 public:
  SampledField sample(const SphereSet& spheres, const ExtractOptions& options) const override {
    SampledField field;
    const FieldModel model = begin_sampling(field, spheres, options);
    field.values.resize(field.grid.node_count());
    WorkspaceOfCall workspace(options.workspace);
    const CellListView list = field_list(spheres, model, options.frame, workspace);
    const Sampling sampling{list, model, field.values.data()};
    const auto sample_row =
        with_blended(model.kind, []<class Kind>(Kind) { return &vdwmesh::sample_row<Kind>; });
    const std::int32_t height = brick_count(field.grid.cells.y);
    const std::int32_t rows = height * brick_count(field.grid.cells.z);
    begin_stage(options.monitor, "field", static_cast<std::uint64_t>(rows));
    tbb::parallel_for(std::int32_t{0}, rows, [&](std::int32_t row) {
      sample_row(sampling, {row % height, row / height});
      advance(options.monitor, 1);
    });
    return field;
  }

  void mesh_into(ExtractResult& result, const SampledFieldView& field,
                 const ExtractOptions& options) const override {
    check_sampled(field);
    const BrickLoops loops{
        [&](Keys keys, ActiveBrick* out) { return count_sampled(field, keys, out); },
        [&](const Emission& e, std::size_t begin, std::size_t end) {
          return emit_sampled(field, e, begin, end);
        }};
    WorkspaceOfCall workspace(options.workspace);
    mesh_bricks(
        result, field.grid, [&] { return all_bricks(field.grid); }, loops, LabelWidth::none,
        options, workspace);
  }
};

}  // namespace

void FieldMesher::mesh_into(ExtractResult& result, const SampledField& field,
                            const ExtractOptions& options) const {
  check_values(field);
  mesh_into(result, field.view(), options);
}

ExtractResult FieldMesher::mesh(const SampledField& field, const ExtractOptions& options) const {
  ExtractResult result;
  mesh_into(result, field, options);
  return result;
}

ExtractResult FieldMesher::mesh(const SampledFieldView& field,
                                const ExtractOptions& options) const {
  ExtractResult result;
  mesh_into(result, field, options);
  return result;
}

std::unique_ptr<FieldMesher> make_cpu_field_mesher() { return std::make_unique<CpuFieldMesher>(); }

}  // namespace vdwmesh
