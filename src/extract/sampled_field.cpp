// FieldMesher on the CPU: marching cubes over all bricks (bricks/brick_mesher.hpp) with signs and
// vertices from the stored values instead of the spheres.
#include "extract/sampled_field.hpp"

#include "core/lanes/multiversion.hpp"
#include "core/workspace.hpp"
#include "extract/blended/sampled_formulas.hpp"
#include "extract/bricks/brick_mesher.hpp"
#include "extract/limits.hpp"

namespace vdwmesh {
namespace {

using Keys = std::span<const std::uint64_t>;

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

ExtractResult FieldMesher::mesh(const SampledFieldView& field,
                                const ExtractOptions& options) const {
  ExtractResult result;
  mesh_into(result, field, options);
  return result;
}

std::unique_ptr<FieldMesher> make_cpu_field_mesher() { return std::make_unique<CpuFieldMesher>(); }

}  // namespace vdwmesh
