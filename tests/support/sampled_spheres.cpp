// Visits all bricks, rows along x in parallel, and stores the values that the Extractor computes in
// them.
#include "support/sampled_spheres.hpp"

#include <tbb/parallel_for.h>

#include "core/lanes/multiversion.hpp"
#include "extract/blended/blended_brick.hpp"
#include "extract/blended/sampled_formulas.hpp"
#include "extract/field_kinds.hpp"
#include "extract/field_list.hpp"

namespace vdwmesh::testing {
namespace {

// Writes the values of the nodes that the brick owns and that belong to the grid.
void store(const BrickValues& field, const BrickGeometry& g, const GridSpec& grid, float* values) {
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      if ((g.real[1] >> y & g.real[2] >> z & 1) == 0) continue;
      for (int x = 0; x < kBrickSide; ++x) {
        if ((g.real[0] >> x & 1) == 0) continue;
        const int node[3] = {x, y, z};
        const SampledFieldView view{grid, values, 0};
        values[node_address(view, lattice_node(g.brick, node)) - view.values] = field.row[z][y][x];
      }
    }
  }
}

// The row of bricks along x with the index `row` among all, y faster than z. VDWMESH_MULTIVERSION
// compiles it for two processor versions.
template <BlendedKind Kind>
VDWMESH_MULTIVERSION void sample_row(const CellListView& list, const FieldModel& model,
                                     float* values, std::int32_t row) {
  const GridSpec& grid = model.grid;
  const std::int32_t height = brick_count(grid.cells.y);
  BlendedBrick<Kind> surface(list, model);
  BrickValues field;
  for (std::int32_t x = 0; x < brick_count(grid.cells.x); ++x) {
    const BrickIndex brick{x, row % height, row / height};
    surface.visit(brick);
    surface.values(field);
    store(field, brick_geometry(grid, brick), grid, values);
  }
}

}  // namespace

SampledField sampled_spheres(const SphereSet& spheres, const ExtractOptions& options) {
  SampledField field;
  field.grid = make_grid(spheres, options.grid);
  const FieldModel model = make_field_model(options.field, field.grid);
  field.isovalue = static_cast<float>(model.isovalue);
  field.values.resize(field.grid.node_count());
  const CellList list = make_field_list(spheres, model, options.frame);
  const auto sample = with_blended(model.kind, []<class Kind>(Kind) { return &sample_row<Kind>; });
  const std::int32_t rows = brick_count(field.grid.cells.y) * brick_count(field.grid.cells.z);
  tbb::parallel_for(std::int32_t{0}, rows, [&](std::int32_t row) {
    sample(list.view(), model, field.values.data(), row);
  });
  return field;
}

}  // namespace vdwmesh::testing
