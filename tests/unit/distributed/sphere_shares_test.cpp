// The spheres that each rank measures, and those near them; sets that ranks found each for itself.
#include "distributed/shares/sphere_shares.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/workspace.hpp"
#include "distributed/together/joined_sets.hpp"
#include "measures/arcs/arcs.hpp"
#include "spheres/box.hpp"

namespace vdwmesh {
namespace {

std::vector<Sphere> random_spheres(std::size_t count, Vec3d size) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1), radius(0.5, 2);
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = size.x * unit(random), y = size.y * unit(random), z = size.z * unit(random);
    spheres.push_back({{x, y, z}, radius(random)});
  }
  return spheres;
}

// The shares of all parts, as ranks make them together.
std::vector<SphereShare> shares_of(const SphereSet& spheres, std::size_t parts) {
  std::vector<SphereBlock> blocks;
  Box box = empty_box();
  const std::size_t count = spheres.size();
  for (std::size_t block = 0; block < parts; ++block) {
    blocks.emplace_back(spheres, count * block / parts, count * (block + 1) / parts, parts);
    include(box, blocks.back().box_of_centers());
  }
  std::vector<std::vector<std::uint64_t>> before;
  std::vector<std::uint64_t> all(4096);
  for (SphereBlock& block : blocks) {
    before.push_back(all);
    const std::vector<std::uint64_t> counts = block.count_layers(box);
    for (std::size_t layer = 0; layer < counts.size(); ++layer) all[layer] += counts[layer];
  }
  std::vector<PartExtent> extents(parts);
  for (std::size_t block = 0; block < parts; ++block) {
    const std::vector<PartExtent> of_block = blocks[block].divide(all, before[block]);
    for (std::size_t part = 0; part < parts; ++part) extents[part].add(of_block[part]);
  }
  std::vector<std::vector<std::vector<NamedSphere>>> to_part(parts);
  for (const SphereBlock& block : blocks) {
    std::vector<std::vector<NamedSphere>> sent = block.choose(extents);
    for (std::size_t part = 0; part < parts; ++part) to_part[part].push_back(sent[part]);
  }
  std::vector<SphereShare> shares;
  for (std::size_t part = 0; part < parts; ++part) {
    shares.push_back(gather_share(part, spheres, to_part[part]));
  }
  return shares;
}

bool touch(const Sphere& a, const Sphere& b) {
  const Vec3d to = a.center - b.center;
  const double sum = a.radius + b.radius;
  return dot(to, to) <= sum * sum;
}

// Every sphere is in one share, and every share has all that touch its spheres.
void expect_sound_shares(const SphereSet& spheres, std::size_t parts) {
  std::vector<int> shares(spheres.size());
  const std::vector<SphereShare> all = shares_of(spheres, parts);
  for (const auto& [near, own, owner] : all) {
    ASSERT_EQ(owner.size(), near.ids.size());
    EXPECT_TRUE(std::ranges::is_sorted(near.ids));
    EXPECT_TRUE(std::ranges::is_sorted(own));
    EXPECT_LE(own.size(), spheres.size() / parts + 1);
    for (const SphereId i : own) {
      ++shares[near.ids[i]];
      for (std::size_t other = 0; other < spheres.size(); ++other) {
        if (!touch(spheres[near.ids[i]], spheres[other])) continue;
        ASSERT_TRUE(std::ranges::binary_search(near.ids, static_cast<SphereId>(other)));
      }
    }
    for (std::size_t i = 0; i < near.ids.size(); ++i) {
      EXPECT_EQ(near.spheres[i].center, spheres[near.ids[i]].center);
      const SphereShare& of_owner = all[owner[i]];
      const auto found = std::ranges::lower_bound(of_owner.near.ids, near.ids[i]);
      const auto place = static_cast<SphereId>(found - of_owner.near.ids.begin());
      EXPECT_TRUE(std::ranges::binary_search(of_owner.own, place));
    }
  }
  EXPECT_EQ(shares, std::vector<int>(spheres.size(), 1)) << parts;
}

TEST(SphereShares, HaveAllSpheresOnceAndAllThatTouchThem) {
  for (const std::size_t parts : {1u, 2u, 3u, 7u, 400u}) {
    expect_sound_shares(SphereSet(random_spheres(300, {10, 30, 20})), parts);
    expect_sound_shares(SphereSet(random_spheres(300, {0, 0, 0})), parts);  // all in one layer
    expect_sound_shares(SphereSet({{{1, 2, 3}, 1}}), parts);
  }
}

TEST(SphereShares, TouchingSpheresFarFromTheOriginAreNear) {
  constexpr double kFar = 1e9;  // Å; coordinates are rounded by 1e-7 Å there
  const SphereSet spheres({{{kFar, 0, 0}, 1}, {{kFar + 2, 0, 0}, 1}, {{kFar + 9, 0, 0}, 1}});
  EXPECT_EQ(shares_of(spheres, 3)[0].near.ids, (std::vector<SphereId>{0, 1}));
  EXPECT_EQ(shares_of(spheres, 3)[2].near.ids, (std::vector<SphereId>{2}));
}

TEST(SphereShares, AreCutAcrossTheLongestAxis) {
  const SphereSet spheres(random_spheres(4000, {20, 1000, 20}));
  EXPECT_LE(shares_of(spheres, 10)[5].near.ids.size(), 450u);
}

// Atoms of a crystal: many neighbours at the same distance, so that ties decide in which order the
// planes of a power cell are cut.
std::vector<Sphere> crystal(double radius) {
  std::vector<Sphere> spheres;
  for (int x = 0; x < 9; ++x) {
    for (int y = 0; y < 5; ++y) {
      for (int z = 0; z < 4; ++z) {
        spheres.push_back({{1.1 * x, 1.1 * y, 1.1 * z}, radius});
        spheres.push_back({{1.1 * x + 0.55, 1.1 * y + 0.55, 1.1 * z + 0.55}, 0.9 * radius});
      }
    }
  }
  return spheres;
}

void expect_bits_of_whole(const SphereSet& spheres, std::size_t parts) {
  const ArcMeasures whole = arc_measures(spheres);
  for (const auto& [near, own, owner] : shares_of(spheres, parts)) {
    const MeasuredSpheres measured(near.spheres.size(), own);
    ArcMeasures arcs{};
    Workspace workspace;
    arc_measures(arcs, SphereSet::view(near.spheres), {.measured = measured}, workspace);
    for (const SphereId i : own) {
      EXPECT_EQ(arcs.per_sphere[i].area, whole.per_sphere[near.ids[i]].area);
      EXPECT_EQ(arcs.per_sphere[i].volume, whole.per_sphere[near.ids[i]].volume);
    }
  }
}

TEST(SphereShares, MeasuresHaveTheBitsOfTheWhole) {
  for (const std::size_t parts : {1u, 2u, 5u, 11u}) {
    expect_bits_of_whole(SphereSet(random_spheres(300, {10, 30, 20})), parts);
    for (const double radius : {0.6, 0.8, 1.0}) {
      expect_bits_of_whole(SphereSet(crystal(radius)), parts);
    }
  }
}

TEST(JoinedSets, SetsThatShareAnElementAreOne) {
  EXPECT_EQ(JoinedSets({}).count(5), 5u);
  EXPECT_EQ(JoinedSets({{1, 10}, {2, 20}}).count(5), 5u);
  EXPECT_EQ(JoinedSets({{1, 10}, {1, 20}}).count(5), 4u);
  // A chain of three, and the same pair again by another element.
  JoinedSets chain({{7, 10}, {9, 30}, {8, 20}, {7, 20}, {8, 30}, {9, 20}, {5, 15}});
  EXPECT_EQ(chain.count(6), 4u);
  EXPECT_EQ(chain.number_of(10), chain.number_of(30));
  EXPECT_NE(chain.number_of(10), chain.number_of(15));
  EXPECT_EQ(chain.number_of(11), std::nullopt);
  EXPECT_EQ(chain.number_of(99), std::nullopt);
  EXPECT_EQ(JoinedSets({{1, 10}, {1, 10}}).count(2), 2u);
}

}  // namespace
}  // namespace vdwmesh
