#include "spheres/cell_list.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "core/errors.hpp"
#include "spheres/level_extent.hpp"

namespace vdwmesh {
namespace {

std::vector<Sphere> random_spheres(std::size_t count, double box, double r_min, double r_max,
                                   unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-box, box), radius(r_min, r_max);
  std::vector<Sphere> spheres(count);
  for (Sphere& s : spheres) s = {{place(random), place(random), place(random)}, radius(random)};
  return spheres;
}

bool reaches_box(const Sphere& s, const Vec3d& lower, const Vec3d& upper) {
  for (int axis = 0; axis < 3; ++axis) {
    if (s.center[axis] < lower[axis] - s.radius || s.center[axis] > upper[axis] + s.radius) {
      return false;
    }
  }
  return true;
}

void expect_finds_all(const SphereSet& spheres, unsigned seed) {
  const CellList list = make_ball_list(spheres);
  const Box box = bounding_box(spheres);
  std::mt19937_64 random(seed);
  for (int query = 0; query < 200; ++query) {
    Vec3d lower{}, upper{};
    for (int axis = 0; axis < 3; ++axis) {
      const double extent = box.upper[axis] - box.lower[axis];
      std::uniform_real_distribution<double> place(box.lower[axis] - 0.2 * extent,
                                                   box.upper[axis] + 0.2 * extent);
      lower[axis] = place(random);
      upper[axis] = lower[axis] + extent * 0.05 * (query % 4);
    }
    std::set<SphereId> found;
    std::int64_t previous = -1;
    visit_near_box(list.view(), lower, upper, [&](ListPlace place) {
      EXPECT_GT(static_cast<std::int64_t>(place), previous) << "not in list order";
      previous = static_cast<std::int64_t>(place);
      EXPECT_TRUE(found.insert(list.view().id[place]).second);
      return false;
    });
    for (SphereId i = 0; i < spheres.size(); ++i) {
      if (reaches_box(spheres[i], lower, upper)) {
        EXPECT_TRUE(found.contains(i));
      }
    }
  }
}

TEST(CellList, FindsEverySphereNearABox) {
  expect_finds_all(SphereSet(random_spheres(1, 5, 1, 2, 1)), 1);
  expect_finds_all(SphereSet(random_spheres(500, 20, 1, 2, 2)), 2);
}

TEST(CellList, FindsSpheresOfVeryDifferentSizesAndPlaces) {
  std::vector<Sphere> spheres = random_spheres(300, 10, 0.001, 0.01, 3);
  spheres.push_back({{3, 0, 0}, 500});
  spheres.push_back({{1e6, -1e6, 1e6}, 2});
  expect_finds_all(SphereSet(spheres), 4);
}

TEST(CellList, OrdersBySpheresNotByInput) {
  std::vector<Sphere> spheres = random_spheres(400, 8, 1, 2, 5);
  spheres.push_back(spheres[7]);  // an exact duplicate
  std::vector<Sphere> shuffled = spheres;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937_64(6));
  const CellList a = make_ball_list(SphereSet(spheres)), b = make_ball_list(SphereSet(shuffled));
  for (std::uint32_t i = 0; i < a.view().size; ++i) {
    const ListPlace place{i};
    EXPECT_EQ(a.view().spheres[place].center, b.view().spheres[place].center);
    EXPECT_EQ(a.view().rank[place], b.view().rank[place]);
  }
}

TEST(CellList, StopsWhenAsked) {
  const CellList list = make_ball_list(SphereSet(random_spheres(50, 1, 1, 2, 7)));
  int visits = 0;
  EXPECT_TRUE(
      visit_near_box(list.view(), {0, 0, 0}, {0, 0, 0}, [&](ListPlace) { return ++visits == 3; }));
  EXPECT_EQ(visits, 3);
}

// Octaves of the smallest reach; a ratio that rounding has put just below a power of two has that
// power's level.
TEST(CellList, LevelsAreOctaves) {
  EXPECT_EQ(level_of(1, 1), 0);
  EXPECT_EQ(level_of(1.999999, 1), 0);
  EXPECT_EQ(level_of(std::nextafter(2.0, 0.0), 1), 1);
  EXPECT_EQ(level_of(2, 1), 1);
  EXPECT_EQ(level_of(0.3 * 8, 0.3), 3);
  EXPECT_EQ(level_of(0.5, 1), 0);  // smaller than the smallest of a given frame
  EXPECT_EQ(level_of(1e30, 1e-300), CellListView::kMaxLevels - 1);  // the ratio is infinite
}

// Two parts of a set, in the frame of the whole: each query finds the spheres that both have in the
// same order, which is also the whole's.
TEST(CellList, PartsInOneFrameVisitSharedSpheresInOneOrder) {
  const std::vector<Sphere> all = random_spheres(400, 8, 0.5, 4, 9);
  const SphereSet whole(all);
  std::vector<double> reach;
  for (const Sphere& s : all) reach.push_back(s.radius);
  const CellListFrame frame = make_frame(whole, reach);
  const CellList list(whole, reach);
  std::mt19937_64 random(10);
  for (int part = 0; part < 5; ++part) {
    std::vector<Sphere> some;
    std::vector<double> some_reach;
    std::vector<SphereId> ids;
    for (SphereId i = 0; i < all.size(); ++i) {
      if (random() % 3 == 0) continue;
      some.push_back(all[i]);
      some_reach.push_back(reach[i]);
      ids.push_back(i);
    }
    const CellList sub(SphereSet(some), some_reach, frame);
    for (int q = 0; q < 50; ++q) {
      const Vec3d at = all[random() % all.size()].center;
      std::vector<SphereId> expected, found;
      visit_near_box(list.view(), at, at, [&](ListPlace place) {
        const SphereId id = list.view().id[place];
        if (std::ranges::binary_search(ids, id)) expected.push_back(id);
        return false;
      });
      visit_near_box(sub.view(), at, at, [&](ListPlace place) {
        found.push_back(ids[sub.view().id[place]]);
        return false;
      });
      ASSERT_EQ(found, expected);
    }
  }
}

TEST(CellList, RebuildingIsLikeBuilding) {
  CellList kept;
  for (const unsigned seed : {11u, 12u, 13u}) {
    const SphereSet spheres(random_spheres(20 + 70 * (seed % 3), 5, 0.1, 6, seed));
    std::vector<double> reach;
    for (const Sphere& s : spheres.spheres()) reach.push_back(s.radius);
    kept.rebuild(spheres, reach);
    const CellList fresh(spheres, reach);
    ASSERT_EQ(kept.view().size, fresh.view().size);
    ASSERT_EQ(kept.view().level_count, fresh.view().level_count);
    for (std::uint32_t i = 0; i < fresh.view().size; ++i) {
      const ListPlace place{i};
      ASSERT_EQ(kept.view().id[place], fresh.view().id[place]);
      ASSERT_EQ(kept.view().rank[place], fresh.view().rank[place]);
    }
  }
}

// Enough spheres for many blocks and groups: on a coarse lattice, so that many are in one place and
// more in one plane; in one plane across x; and with one of them far away from all others.
std::vector<std::vector<Sphere>> many_spheres() {
  std::vector<Sphere> lattice = random_spheres(60'000, 40, 0.2, 3, 14), plane = lattice;
  for (Sphere& s : lattice) {
    for (int axis = 0; axis < 3; ++axis) s.center[axis] = std::round(s.center[axis]);
    s.radius = std::ldexp(1.0, std::ilogb(s.radius));
  }
  for (Sphere& s : plane) s.center.x = 1.5;
  std::vector<Sphere> far = lattice;
  far.push_back({{1e30, 0, 0}, 1});
  return {lattice, plane, far};
}

std::vector<SphereId> sorted_ids(const std::vector<Sphere>& spheres) {
  std::vector<SphereId> ids(spheres.size());
  std::iota(ids.begin(), ids.end(), 0u);
  std::ranges::sort(ids, {}, [&](SphereId i) {
    const Sphere& s = spheres[i];
    return std::tuple(s.center.x, s.center.y, s.center.z, s.radius, i);
  });
  return ids;
}

TEST(CellList, OrderOfManySpheresOnAnyThreads) {
  for (const std::vector<Sphere>& spheres : many_spheres()) {
    const SphereSet set(spheres);
    const std::vector<SphereId> expected = sorted_ids(spheres);
    for (const std::size_t threads : {1u, 4u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      ASSERT_EQ(canonical_order(set), expected);
    }
  }
}

// Every sphere stands once, in the level of its reach, in the cell of its centre, and there by
// rank.
TEST(CellList, PlacesOfManySpheresOnAnyThreads) {
  for (const std::vector<Sphere>& spheres : many_spheres()) {
    const SphereSet set(spheres);
    const std::vector<SphereId> order = sorted_ids(spheres);
    std::vector<double> reach;
    for (const Sphere& s : spheres) reach.push_back(s.radius);
    const double smallest = std::ranges::min(reach);
    for (const std::size_t threads : {1u, 4u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      const CellList made(set, reach);
      const CellListView& list = made.view();
      ASSERT_EQ(list.size, spheres.size());
      std::uint32_t next = 0;  // list place
      int last_octave = -1;
      for (int l = 0; l < list.level_count; ++l) {
        const CellListView::Level& level = list.levels[l];
        const int octave = level_of(list.spheres[ListPlace{next}].radius, smallest);
        ASSERT_GT(octave, last_octave);
        last_octave = octave;
        ASSERT_EQ(level.cell_start[0], next);
        for (std::size_t cell = 0; cell < cell_count(level); ++cell) {
          for (; next < level.cell_start[cell + 1]; ++next) {
            const ListPlace place{next};
            const SphereId id = list.id[place];
            ASSERT_EQ(order[to_index(list.rank[place])], id);
            ASSERT_EQ(list.spheres[place].center, spheres[id].center);
            ASSERT_EQ(list.spheres[place].radius, spheres[id].radius);
            ASSERT_EQ(level_of(spheres[id].radius, smallest), octave);
            ASSERT_EQ(cell_index(level, spheres[id].center), cell);
            ASSERT_TRUE(next == level.cell_start[cell] ||
                        list.rank[ListPlace{next - 1}] < list.rank[place]);
          }
        }
      }
      ASSERT_EQ(next, list.size);  // so each place was seen, and each rank stands in one
    }
  }
}

TEST(CellList, OfManySpheresThatDoNotFitTheFirstInTheOrderIsNamed) {
  const std::vector<Sphere> spheres = many_spheres()[0];
  const SphereSet set(spheres);
  std::vector<double> reach(spheres.size(), 1);
  CellListFrame frame = make_frame(set, reach);
  frame.levels[0].reach = 0.5;  // fits none
  const std::string first = "sphere " + std::to_string(sorted_ids(spheres)[0]) + ":";
  try {
    const CellList list(set, reach, frame);
    FAIL() << "accepted";
  } catch (const InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, first.size()), first);
  }
}

// What follows must not compile: it takes one number of a sphere for another.
template <class Index>
concept NamesListedSphere = requires(const CellListView& list, Index i) {
  list.spheres[i];
};
template <class Index>
concept NamesSphere = requires(const SphereSet& spheres, Index i) {
  spheres[i];
};

TEST(CellList, ANumberOfASphereIsNotTakenForAnother) {
  EXPECT_TRUE(NamesListedSphere<ListPlace>);
  EXPECT_FALSE(NamesListedSphere<SphereId>);
  EXPECT_FALSE(NamesListedSphere<Rank>);
  EXPECT_TRUE(NamesSphere<SphereId>);
  EXPECT_FALSE(NamesSphere<ListPlace>);
  EXPECT_FALSE(NamesSphere<Rank>);
  EXPECT_FALSE((std::is_convertible_v<ListPlace, Rank> || std::is_convertible_v<Rank, ListPlace>));
  EXPECT_TRUE(std::is_trivially_copyable_v<CellListView>);  // it is passed to kernels by value
}

TEST(CellList, NoSpheres) {
  CellList list(SphereSet(random_spheres(10, 5, 1, 2, 1)), std::vector<double>(10, 1));
  list.rebuild(SphereSet(), {});
  EXPECT_EQ(list.view().size, 0u);
  EXPECT_FALSE(visit_near_box(list.view(), {0, 0, 0}, {1, 1, 1}, [](ListPlace) { return true; }));
}

}  // namespace
}  // namespace vdwmesh
