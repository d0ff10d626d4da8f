// A list of bricks that lacks one with surface: an error, never a mesh that links another brick.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "extract/bricks/brick_extraction.hpp"
#include "extract/field_list.hpp"
#include "extract/union/union_brick.hpp"
#include "support/mesh_bricks.hpp"
#include "support/plain_extractor.hpp"

namespace vdwmesh {
namespace {

// A ball of 12 spacings across, so that the surface runs through 3 x 3 x 3 bricks.
class MissingBrick : public ::testing::TestWithParam<Connectivity> {
 protected:
  MissingBrick() {
    options_.grid.spacing = 0.5;
    options_.connectivity = GetParam();
  }
  // Meshes the bricks with these keys as the extractor does.
  ExtractResult mesh(const std::vector<std::uint64_t>& keys) const {
    const GridSpec grid = make_grid(ball_, options_.grid);
    const FieldModel model = make_field_model(options_.field, grid);
    const CellList list = make_field_list(ball_, model);
    const BrickLoops loops{[&](std::span<const std::uint64_t> some, ActiveBrick* out) {
                             UnionBrick surface(list.view(), model);
                             return count_bricks(surface, grid, some, out);
                           },
                           [&](const Emission& e, std::size_t begin, std::size_t end) {
                             UnionBrick surface(list.view(), model);
                             return emit_bricks(e, begin, end, surface);
                           }};
    return testing::mesh_bricks(
        grid, [&] { return keys; }, loops, LabelWidth::one, options_);
  }
  std::vector<std::uint64_t> keys() const {
    return testing::all_bricks(make_grid(ball_, options_.grid));
  }

  const SphereSet ball_{{{{0, 0, 0}, 4}}};
  ExtractOptions options_;
};

TEST_P(MissingBrick, IsAnErrorWhereTheSurfaceReachesIt) {
  const std::vector<std::uint64_t> all = keys();
  const IndexedMeshHash whole = hash(mesh(all).mesh);
  std::size_t refused = 0;
  for (std::size_t left_out = 0; left_out < all.size(); ++left_out) {
    std::vector<std::uint64_t> some = all;
    some.erase(some.begin() + static_cast<std::ptrdiff_t>(left_out));
    try {
      // A brick without surface is not missed.
      EXPECT_EQ(hash(mesh(some).mesh), whole) << "brick " << left_out;
    } catch (const InternalError& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()).find("neighbour"), std::string::npos);
    }
  }
  EXPECT_GE(refused, 8u);  // at least one for each octant of the sphere
  EXPECT_LT(refused, all.size());
}

INSTANTIATE_TEST_SUITE_P(Arrays, MissingBrick,
                         ::testing::Values(Connectivity::triangles, Connectivity::half_edges),
                         [](const auto& each) {
                           return each.param == Connectivity::triangles ? "triangles"
                                                                        : "half_edges";
                         });

}  // namespace
}  // namespace vdwmesh
