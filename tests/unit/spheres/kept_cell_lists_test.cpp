#include "spheres/kept_cell_lists.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

std::vector<Sphere> row(int count) {
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) spheres.push_back({{1.5 * i, 0, 0}, 1});
  return spheres;
}

std::vector<std::uint32_t> near_first(const CellListView& list) {
  std::vector<std::uint32_t> near;
  visit_near_box(list, {0, 0, 0}, {0, 0, 0}, [&](ListPlace place) {
    near.push_back(list.id[place]);
    return false;
  });
  return near;
}

TEST(KeptCellLists, AListIsBuiltOnceForTheSameSpheresAndReaches) {
  const SphereSet spheres(row(50));
  const std::vector<double> near(50, 1.0), far(50, 4.0);
  KeptCellLists kept;
  const Sphere* const first = kept.get(spheres, near, nullptr).spheres.data();
  const Sphere* const second = kept.get(spheres, far, nullptr).spheres.data();
  EXPECT_NE(first, second);
  const SphereSet copy = spheres;
  EXPECT_EQ(kept.get(copy, near, nullptr).spheres.data(), first);
  EXPECT_EQ(kept.get(spheres, far, nullptr).spheres.data(), second);
  EXPECT_EQ(kept.get(spheres, near, nullptr).spheres.data(), first);
  EXPECT_EQ(kept.get(spheres, near, nullptr).levels[0].reach,
            make_frame(spheres, near).levels[0].reach);
}

// What changes makes another list, in memory that is there.
TEST(KeptCellLists, SpheresThatMovedAreBinnedAnew) {
  SphereSet spheres(row(4));
  const std::vector<double> reach(4, 1.0);
  KeptCellLists kept;
  EXPECT_EQ(near_first(kept.get(spheres, reach, nullptr)).front(), 0u);
  spheres.move_to(std::vector<Vec3d>{{90, 0, 0}, {80, 0, 0}, {70, 0, 0}, {0, 0, 0}});
  EXPECT_EQ(near_first(kept.get(spheres, reach, nullptr)), std::vector<std::uint32_t>{3});
  spheres.move_to(std::vector<Vec3d>{{0, 0, 0}, {80, 0, 0}, {70, 0, 0}, {50, 0, 0}});
  EXPECT_EQ(near_first(kept.get(spheres, reach, nullptr)), std::vector<std::uint32_t>{0});
}

TEST(KeptCellLists, AFrameIsPartOfTheQuestion) {
  const SphereSet spheres(row(10)), more(row(100));
  const std::vector<double> reach(10, 1.0), more_reach(100, 1.0);
  const CellListFrame frame = make_frame(more, more_reach);
  KeptCellLists kept;
  const int own = kept.get(spheres, reach, nullptr).levels[0].cells[0];
  const int given = kept.get(spheres, reach, &frame).levels[0].cells[0];
  EXPECT_LT(own, given);
  EXPECT_EQ(kept.get(spheres, reach, nullptr).levels[0].cells[0], own);
  CellListFrame other = frame;
  other.levels[0].cells[0] += 7;
  EXPECT_EQ(kept.get(spheres, reach, &other).levels[0].cells[0], given + 7);
}

// After a list that could not be built the entry holds none, rather than half of one.
TEST(KeptCellLists, AListThatIsRefusedIsForgotten) {
  const SphereSet few(row(3)), many(row(30));
  const std::vector<double> reach(3, 1.0), many_reach(30, 1.0);
  const CellListFrame frame = make_frame(few, reach);
  KeptCellLists kept;
  EXPECT_THROW(kept.get(many, many_reach, &frame), InvalidInput);
  EXPECT_THROW(kept.get(many, many_reach, &frame), InvalidInput);
  EXPECT_EQ(kept.get(many, many_reach, nullptr).size, 30u);
}

}  // namespace
}  // namespace vdwmesh
