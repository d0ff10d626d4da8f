// The search for bricks against all bricks of the grid: it may keep bricks without surface, but
// must not lose one with surface.
#include "extract/brick_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "extract/blended_brick.hpp"
#include "extract/brick_extraction.hpp"
#include "extract/field_sample.hpp"
#include "extract/union_brick.hpp"
#include "support/dice.hpp"

namespace vdwmesh {
namespace {

using testing::Dice;

struct Searched {
  GridSpec grid;
  FieldModel model;
  CellList list;

  Searched(const SphereSet& spheres, const ExtractOptions& options)
      : grid(make_grid(spheres, options.grid)),
        model(make_field_model(options.field, grid)),
        list(make_field_list(spheres, model)) {}
};

std::vector<std::uint64_t> all_bricks(const GridSpec& grid) {
  std::vector<std::uint64_t> keys;
  for (std::int32_t z = 0; z < brick_count(grid.cells.z); ++z) {
    for (std::int32_t y = 0; y < brick_count(grid.cells.y); ++y) {
      for (std::int32_t x = 0; x < brick_count(grid.cells.x); ++x)
        keys.push_back(brick_key({x, y, z}));
    }
  }
  return keys;
}

template <class Surface>
std::vector<std::uint64_t> with_surface(const Searched& s) {
  const std::vector<std::uint64_t> keys = all_bricks(s.grid);
  std::vector<ActiveBrick> bricks(keys.size());
  Surface surface(s.list.view(), s.model);
  bricks.resize(count_bricks(surface, s.grid, keys, bricks.data()));
  std::vector<std::uint64_t> result;
  for (const ActiveBrick& brick : bricks) result.push_back(brick.key);
  return result;
}

std::vector<std::uint64_t> with_surface(const Searched& s) {
  switch (s.model.kind) {
    case FieldKind::vdw:
      return with_surface<UnionBrick>(s);
    case FieldKind::blinn:
      return with_surface<BlendedBrick<FieldKind::blinn>>(s);
    case FieldKind::soft_object:
      return with_surface<BlendedBrick<FieldKind::soft_object>>(s);
    case FieldKind::inverse_squared:
      break;
  }
  return with_surface<BlendedBrick<FieldKind::inverse_squared>>(s);
}

void expect_none_lost(const SphereSet& spheres, const ExtractOptions& options,
                      const std::string& what) {
  const Searched s(spheres, options);
  const std::vector<std::uint64_t> found =
      candidate_bricks(s.list.view(), s.model, std::numeric_limits<std::uint64_t>::max(), nullptr);
  ASSERT_TRUE(std::ranges::is_sorted(found)) << what;
  const std::vector<std::uint64_t> there = with_surface(s);
  ASSERT_FALSE(there.empty()) << what;
  EXPECT_TRUE(std::ranges::includes(found, there)) << what;
}

// Few balls in a wide box: blocks of 64 and more nodes a side hold several of them far apart.
SphereSet gas(Dice& dice) {
  std::vector<Sphere> spheres(static_cast<std::size_t>(dice.whole(2, 60)));
  const double half = dice.real(5, 16);
  for (Sphere& s : spheres) {
    for (int axis = 0; axis < 3; ++axis) s.center[axis] = dice.real(-half, half);
    s.radius = dice.real(0.3, 3);
  }
  return SphereSet(std::move(spheres));
}

TEST(BrickSearch, LosesNoBrickOfASparseGas) {
  Dice dice(1);
  for (int set = 0; set < 150; ++set) {
    const SphereSet spheres = gas(dice);
    ExtractOptions options;
    options.field.kind = static_cast<FieldKind>(set % 4);
    options.grid.spacing = dice.real(0.25, 0.4);
    expect_none_lost(spheres, options, "set " + std::to_string(set));
  }
}

}  // namespace
}  // namespace vdwmesh
