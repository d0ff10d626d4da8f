// The shares of ranks: runs of bricks of equal area, and the spheres near them.
#include "distributed/shares/surface_shares.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "core/fixed_blocks.hpp"
#include "extract/area_estimate.hpp"
#include "measures/exact_union.hpp"
#include "spheres/even_directions.hpp"

namespace vdwmesh {
namespace {

FieldModel union_on(const SphereSet& spheres, double spacing) {
  GridOptions options;
  options.spacing = spacing;
  return make_field_model({}, make_grid(spheres, options));
}

// What all blocks find for each of the parts or runs, as ranks tell each other.
template <class Find>
auto joined_blocks(std::size_t blocks, const Find& find) {
  auto all = find(0);
  for (std::size_t block = 1; block < blocks; ++block) append_to_each(all, find(block));
  return all;
}

// The same of spheres_near_runs(), as ids.
std::vector<std::vector<SphereId>> near_runs(const SphereSet& spheres, const FieldModel& model,
                                             std::span<const std::uint64_t> begins,
                                             HaloCounts halo) {
  std::vector<std::vector<SphereId>> near;
  for (const std::vector<SphereRun>& runs : joined_blocks(begins.size(), [&](std::size_t block) {
         return spheres_near_runs(spheres, model, block, begins, halo);
       })) {
    near.push_back(ids_of(runs));
  }
  return near;
}

// The samples of all parts.
std::vector<SurfaceSample> samples_of(const SphereSet& spheres, const FieldModel& model,
                                      std::size_t parts) {
  const auto near = joined_blocks(
      parts, [&](std::size_t block) { return spheres_near_samples(spheres, model, block, parts); });
  std::vector<SurfaceSample> all;
  for (std::size_t part = 0; part < parts; ++part) {
    const auto samples = sample_surface(spheres, model, part, parts, near[part]);
    all.insert(all.end(), samples.begin(), samples.end());
  }
  return all;
}

double area_of(const std::vector<SurfaceSample>& samples) {
  double area = 0;
  for (const SurfaceSample& s : samples) area += s.area;
  return area;
}

SphereSet column_of(std::size_t count) {
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < count; ++i) {
    spheres.push_back({{0, 0, 10.0 * static_cast<double>(i)}, 2});
  }
  return SphereSet(spheres);
}

TEST(CutBricks, RunsHaveEqualAreas) {
  std::vector<BrickArea> areas;
  for (std::uint64_t key = 0; key < 100; ++key) areas.push_back({99 - key, 2.0});
  EXPECT_EQ(cut_bricks(areas, 4), (std::vector<std::uint64_t>{0, 25, 50, 75}));
}

TEST(CutBricks, AHeavyBrickIsARunOfItsOwn) {
  const std::vector<BrickArea> areas{{3, 1}, {5, 100}, {7, 1}};
  EXPECT_EQ(cut_bricks(areas, 2), (std::vector<std::uint64_t>{0, 7}));
}

TEST(CutBricks, WithFewerBricksThanRanksTheLastOnesHaveNone) {
  EXPECT_EQ(cut_bricks({{5, 1}, {9, 1}}, 4),
            (std::vector<std::uint64_t>{0, 9, kNoBrickKey, kNoBrickKey}));
  EXPECT_EQ(cut_bricks({}, 3), (std::vector<std::uint64_t>{0, kNoBrickKey, kNoBrickKey}));
}

TEST(JoinBricks, GroupsHaveEqualAreas) {
  std::vector<BrickArea> areas;
  for (std::uint64_t key = 0; key < 100; ++key) areas.push_back({99 - key, 2.0});
  const std::vector<BrickArea> groups = join_bricks(areas, 20);
  ASSERT_EQ(groups.size(), 20u);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    EXPECT_EQ(groups[i].key, 5 * i);
    EXPECT_EQ(groups[i].area, 10.0);
  }
}

// Several areas of a brick, and areas that no group has exactly: cuts differ by a group at most.
TEST(JoinBricks, CutsMoveByAGroupAtMost) {
  std::mt19937 random(3);
  constexpr std::size_t kBricks = 5000, kGroups = 250, kRuns = 7;
  std::vector<BrickArea> areas;
  std::vector<double> before(kBricks + 1);  // [k]: the area of bricks below k
  for (std::size_t i = 0; i < 3 * kBricks; ++i) {
    areas.push_back({random() % kBricks, 0.5 + static_cast<double>(random() % 1000) / 1000});
    before[areas.back().key + 1] += areas.back().area;
  }
  std::partial_sum(before.begin(), before.end(), before.begin());
  const double most = before.back() / kGroups + 20;  // Å²; a brick has less than 20
  const std::vector<BrickArea> groups = join_bricks(areas, kGroups);
  EXPECT_LE(groups.size(), kGroups + 1);
  EXPECT_GE(groups.size(), kGroups / 2);
  const auto expected = cut_bricks(areas, kRuns), cut = cut_bricks(groups, kRuns);
  for (std::size_t run = 0; run < kRuns; ++run) {
    EXPECT_NEAR(before[cut[run]], before[expected[run]], most) << run;
  }
  EXPECT_TRUE(join_bricks({}, 3).empty());
}

// Samples of spheres that do not touch are all exposed, so the estimate is exact but for rounding.
TEST(EstimateBricks, ThePartsTogetherAreTheWholeSurface) {
  const SphereSet spheres = column_of(100);
  const double expected = 100 * 4 * std::numbers::pi * 4;  // Å²
  constexpr double kRounding = 1e-9;                       // of sums of 16,000 terms, relative
  for (const std::size_t parts : {1u, 2u, 7u}) {
    const auto samples = samples_of(spheres, union_on(spheres, 0.5), parts);
    EXPECT_NEAR(area_of(samples), expected, kRounding * expected) << parts;
  }
}

// Each part looks only at the spheres near its own; what they cover must not count.
TEST(EstimateBricks, PartsKnowWhatTheOthersCover) {
  std::mt19937 random(5);
  std::vector<Sphere> balls;
  const auto number = [&](double most) { return most * static_cast<double>(random()) / 0x1p32; };
  for (int i = 0; i < 3000; ++i) {
    balls.push_back({{number(40), number(40), number(40)}, 1 + number(1)});
  }
  const SphereSet spheres(balls);
  const double expected = exact_union(spheres).area;
  for (const std::size_t parts : {1u, 3u}) {
    const auto samples = samples_of(spheres, union_on(spheres, 0.5), parts);
    for (const SurfaceSample& s : samples) {
      for (const Sphere& ball : balls) {
        EXPECT_GE(norm(s.point - ball.center), ball.radius * (1 - 1e-9));
      }
    }
    EXPECT_NEAR(area_of(samples), expected, 0.1 * expected) << parts;  // as promised
  }
}

// No point that lies open is left out: all balls tell for each of 8 points of 2,000 spheres.
TEST(SampleSurface, HasAllPointsThatLieOpen) {
  std::mt19937 random(17);
  const auto number = [&](double most) { return most * static_cast<double>(random()) / 0x1p32; };
  std::vector<Sphere> balls{{{20, 20, 20}, 6}};
  while (balls.size() < 2000) {
    balls.push_back({{number(40), number(40), number(40)}, 0.5 + number(2)});
  }
  const SphereSet spheres(balls);
  const auto samples = samples_of(spheres, union_on(spheres, 0.5), 1);
  std::map<SphereId, int> found;
  for (const SurfaceSample& s : samples) ++found[s.sphere];
  constexpr int kPoints = 8;
  for (SphereId id = 0; id < balls.size(); ++id) {
    int open = 0;
    for (int k = 0; k < kPoints; ++k) {
      const Vec3d p = balls[id].center + balls[id].radius * even_direction(k, kPoints);
      open += std::ranges::none_of(balls, [&](const Sphere& ball) {
        return &ball != &balls[id] && norm(p - ball.center) < ball.radius;
      });
    }
    EXPECT_EQ(found[id], open) << id;
  }
}

// The spheres left out have no effect on the samples, for each kind of field and truncation: all
// spheres give the same, but for rounding, because sums of a field run in another order then.
// Spheres have very different sizes.
TEST(SampleSurface, DoesNotNeedTheSpheresThatAreLeftOut) {
  std::mt19937 random(7);
  const auto number = [&](double most) { return most * static_cast<double>(random()) / 0x1p32; };
  std::vector<Sphere> balls{{{15, 15, 15}, 9}};
  for (int i = 0; i < 400; ++i) {
    balls.push_back({{number(30), number(30), number(30)}, 0.3 + number(1.5)});
  }
  // Blocks of numbers are slabs then, and do not reach most samples.
  std::ranges::sort(balls, {}, [](const Sphere& s) { return s.center.y; });
  const SphereSet spheres(balls);
  std::vector<SphereId> all(spheres.size());
  std::iota(all.begin(), all.end(), SphereId{0});
  GridOptions grid;
  grid.spacing = 0.5;
  FieldOptions vdw, blinn, subgrids;
  blinn.kind = FieldKind::blinn;
  subgrids.kind = FieldKind::soft_object;
  subgrids.preset = FieldPreset::thesis;
  for (const FieldOptions& field : {vdw, blinn, subgrids}) {
    const FieldModel model = make_field_model(field, make_grid(spheres, grid));
    for (const std::size_t parts : {1u, 5u}) {
      const auto near = joined_blocks(parts, [&](std::size_t block) {
        return spheres_near_samples(spheres, model, block, parts);
      });
      for (std::size_t part = 0; part < parts; ++part) {
        ASSERT_TRUE(std::ranges::is_sorted(near[part], std::ranges::less_equal()));
        const auto few = sample_surface(spheres, model, part, parts, near[part]);
        const auto with_all = sample_surface(spheres, model, part, parts, all);
        ASSERT_EQ(few.size(), with_all.size());
        EXPECT_FALSE(few.empty());
        double sum = 0, sum_with_all = 0;
        std::map<SphereId, std::size_t> points;
        for (std::size_t i = 0; i < few.size(); ++i) {
          sum += few[i].area;
          sum_with_all += with_all[i].area;
          ++points[few[i].sphere];
          --points[with_all[i].sphere];
        }
        constexpr double kRounding = 1e-9;  // of fields and of sums of 16,000 terms, relative
        EXPECT_NEAR(sum, sum_with_all, kRounding * sum);
        for (const auto& [sphere, difference] : points) EXPECT_EQ(difference, 0u) << sphere;
      }
    }
  }
}

// Most spheres are near no sample, here as in a large structure; all pairs tell which are. The
// sample of a part is every k-th sphere, and a ball reaches a quarter of its radius beyond it.
TEST(SpheresNearSamples, AreThoseWithinReachOfASample) {
  std::mt19937 random(13);
  const auto number = [&](double most) { return most * static_cast<double>(random()) / 0x1p32; };
  constexpr std::size_t kParts = 2, kEach = 40960, kStep = 20;
  std::vector<Sphere> balls;
  for (std::size_t i = 0; i < kParts * kEach; ++i) {
    balls.push_back({{500 + number(150), -number(150), number(150)}, 1 + number(1)});
  }
  const SphereSet spheres(balls);
  const FieldModel model = union_on(spheres, 0.5);
  const auto near = joined_blocks(kParts, [&](std::size_t block) {
    return spheres_near_samples(spheres, model, block, kParts);
  });
  for (std::size_t part = 0; part < kParts; ++part) {
    std::vector<SphereId> expected;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      bool is_near = false;
      for (std::size_t j = part * kEach; j < (part + 1) * kEach && !is_near; j += kStep) {
        const Vec3d d = balls[i].center - balls[j].center;
        const double most = balls[i].radius + 1.25 * balls[j].radius;
        is_near = dot(d, d) <= most * most;  // no two balls are all but at this distance
      }
      if (is_near) expected.push_back(static_cast<SphereId>(i));
    }
    EXPECT_LT(expected.size(), balls.size() / 2);
    EXPECT_EQ(near[part], expected);
  }
}

TEST(CutBricks, SharesOfAColumnAreEqual) {
  const SphereSet spheres = column_of(64);
  const FieldModel model = union_on(spheres, 0.5);
  std::vector<BrickArea> areas;
  for (const SurfaceSample& s : samples_of(spheres, model, 1)) {
    const double layer = (s.point.z - model.grid.origin.z) / 0.5 / kBrickSide;
    areas.push_back({brick_key({0, 0, static_cast<std::int32_t>(layer)}), s.area});
  }
  const auto begins = cut_bricks(areas, 4);
  for (std::size_t rank = 1; rank < 4; ++rank) {
    const double z = model.grid.origin.z + 8 * 0.5 * brick_of_key(begins[rank]).z;
    constexpr double kTwoSpheres = 20;  // Å: bricks do not end where spheres do
    EXPECT_NEAR(z, 160.0 * static_cast<double>(rank), kTwoSpheres) << rank;
  }
}

// The bricks of a run reach from its first layer to that of the run behind it, and if the rank
// counts its halo, one more; layer k holds the nodes 8 k - 1 to 8 k + 7.
void expect_only_near(HaloCounts halo) {
  const SphereSet spheres = column_of(50);
  const FieldModel model = union_on(spheres, 0.5);
  const std::vector<std::uint64_t> begins{0, brick_key({0, 0, 60}), brick_key({0, 0, 61}),
                                          kNoBrickKey};
  const auto near = near_runs(spheres, model, begins, halo);
  for (const std::vector<SphereId>& ids : near) EXPECT_TRUE(std::ranges::is_sorted(ids));
  EXPECT_LE(near[1].size(), 4u);
  EXPECT_GE(near[1].size(), 1u);
  EXPECT_TRUE(near[3].empty());
  const int layers_of_halo = halo == HaloCounts::own ? 1 : 0;
  const auto is_near = [&](double z, std::int32_t first, std::int32_t last) {
    const double lower = model.grid.origin.z + 0.5 * (8 * first - 1),
                 upper = model.grid.origin.z + 0.5 * (8 * last + 7);
    return z + 2 >= lower && z - 2 <= upper;
  };
  for (SphereId id = 0; id < spheres.size(); ++id) {
    const double z = spheres[id].center.z;
    const auto found = [&](std::size_t run) { return std::ranges::binary_search(near[run], id); };
    EXPECT_TRUE(found(0) || !is_near(z, 0, 59 + layers_of_halo)) << id;
    EXPECT_TRUE(found(1) || !is_near(z, 60, 60 + layers_of_halo)) << id;
    EXPECT_TRUE(found(2) || !is_near(z, 61, 1000)) << id;
    EXPECT_TRUE(found(0) || found(1) || found(2)) << id;
  }
}

// Ids of several blocks of the loop, with runs that end where a block does.
TEST(SphereRuns, AreTheIdsThatWereAdded) {
  std::mt19937 random(11);
  std::vector<SphereId> expected;
  std::vector<SphereRun> runs;
  const auto add = [&](SphereId id) {
    expected.push_back(id);
    add_id(id, runs);
  };
  for (SphereId id = 0; id < kIndicesPerBlock; ++id) add(id);
  for (SphereId id = kIndicesPerBlock + 5; id < 5 * kIndicesPerBlock; ++id) {
    if (random() % 3 != 0) add(id);
  }
  EXPECT_LT(runs.size(), expected.size() / 2);
  EXPECT_EQ(ids_of(runs), expected);
  EXPECT_TRUE(ids_of({}).empty());
}

TEST(SpheresNearRuns, OnlyThoseNearTheRun) { expect_only_near(HaloCounts::own); }
TEST(SpheresNearRuns, OnlyThoseNearTheRunAlone) { expect_only_near(HaloCounts::given); }

// Layers of bricks are 4 Å and the balls 1 Å apart, so the layer of the halo has some of its own.
TEST(SpheresNearRuns, AreFewerIfTheHaloIsGiven) {
  std::vector<Sphere> balls;
  for (int i = 0; i < 300; ++i) balls.push_back({{0, 0, 1.0 * i}, 2});
  const SphereSet spheres(balls);
  const FieldModel model = union_on(spheres, 0.5);
  const std::vector<std::uint64_t> begins{0, brick_key({0, 0, 30}), brick_key({0, 0, 31}),
                                          kNoBrickKey};
  const auto count = [&](HaloCounts halo) {
    return near_runs(spheres, model, begins, halo)[0].size();
  };
  EXPECT_LT(count(HaloCounts::given), count(HaloCounts::own));
}

}  // namespace
}  // namespace vdwmesh
