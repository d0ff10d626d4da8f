// Parts that count their own bricks alone and get their halos from each other make the mesh of one
// extraction. The whole extraction and parts that count halos themselves are the reference.
#include "extract/part_without_halo.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "extract/brick_search.hpp"
#include "extract/bricks/brick.hpp"
#include "support/dice.hpp"
#include "support/extract_sets.hpp"

namespace vdwmesh::testing {
namespace {

// Rising keys of random bricks: some ranges are empty, and many end within a row or a layer.
std::vector<KeyRange> random_ranges(const GridSpec& grid, Dice& dice, int count) {
  const auto below = [&](std::int64_t cells) {
    return static_cast<std::int32_t>(dice.whole(0, static_cast<int>(brick_count(cells))));
  };
  std::vector<std::uint64_t> begins{0};
  for (int i = 1; i < count; ++i) {
    begins.push_back(brick_key({below(grid.cells.x), below(grid.cells.y), below(grid.cells.z)}));
  }
  std::ranges::sort(begins);
  std::vector<KeyRange> ranges;
  for (std::size_t i = 0; i < begins.size(); ++i) {
    ranges.push_back({begins[i], i + 1 < begins.size() ? begins[i + 1] : kNoBrickKey});
  }
  return ranges;
}

std::vector<std::unique_ptr<PartWithoutHalo>> parts_with_given_halos(
    const SphereSet& spheres, const ExtractOptions& options, const std::vector<KeyRange>& ranges) {
  std::vector<std::unique_ptr<PartWithoutHalo>> parts;
  for (const KeyRange& range : ranges)
    parts.push_back(count_without_halo(spheres, {}, range, options));
  std::vector<std::vector<std::vector<ActiveBrick>>> halos;
  for (const KeyRange& range : ranges) {
    std::vector<std::vector<ActiveBrick>>& halo = halos.emplace_back();
    for (const auto& part : parts) {
      const auto found = part->counted({range.end, with_halo(range, Connectivity::triangles).end});
      halo.emplace_back(found.begin(), found.end());
    }
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto before = parts[i]->counted(ranges[i]);
    parts[i]->set_halo(halos[i]);
    const auto after = parts[i]->counted(ranges[i]);
    EXPECT_EQ(after.data(), before.data()) << "the bricks were moved to make room";
    EXPECT_EQ(after.size(), before.size());
  }
  return parts;
}

// A layer of this grid has 2 * 10^8 bricks, room for which would take 99 GB, which most systems
// refuse. Only those with surface count.
TEST(PartWithoutHalo, BallsFarFromEachOtherNeedNoRoomForALayer) {
  const SphereSet spheres({{{0, 0, 0}, 1.5}, {{60'000, 60'000, 0}, 1.5}});
  ExtractOptions options;
  options.connectivity = Connectivity::triangles;
  const std::unique_ptr<PartWithoutHalo> part = count_without_halo(spheres, {}, {}, options);
  const std::span<const ActiveBrick> bricks = part->counted({0, kNoBrickKey});
  EXPECT_GT(bricks.size(), 0u);
  EXPECT_LT(bricks.size(), 1000u);
}

TEST(PartWithoutHalo, GivenHalosMakeTheSameMesh) {
  Dice dice(31);
  for (std::uint32_t index = 0; index < 60; ++index) {
    ExtractSet set = extract_set(77, index);
    SCOPED_TRACE(set.name);
    set.options.connectivity = Connectivity::triangles;
    const auto extractor = make_cpu_extractor();
    const ExtractResult whole = extractor->extract(set.spheres, set.options);
    const std::vector<KeyRange> ranges = random_ranges(whole.grid, dice, 5);
    MeshSize first;
    std::int64_t unmatched = 0;
    const auto parts = parts_with_given_halos(set.spheres, set.options, ranges);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const auto counted = extractor->count(set.spheres, ranges[i], set.options);
      EXPECT_EQ(parts[i]->halo().behind, counted->halo().behind);
      EXPECT_EQ(parts[i]->halo().naming_triangles, counted->halo().naming_triangles);
      IndexedMesh mesh;
      unmatched += parts[i]->emit(first, mesh).unmatched_faces;
      ASSERT_LE(first.vertices + mesh.vertex_count(), whole.mesh.vertex_count());
      ASSERT_LE(first.triangles + mesh.triangle_count(), whole.mesh.triangle_count());
      EXPECT_TRUE(std::ranges::equal(
          mesh.triangles,
          std::span(whole.mesh.triangles).subspan(first.triangles, mesh.triangle_count())));
      EXPECT_TRUE(std::ranges::equal(
          mesh.positions,
          std::span(whole.mesh.positions).subspan(first.vertices, mesh.vertex_count())));
      first = {first.vertices + mesh.vertex_count(), first.triangles + mesh.triangle_count()};
    }
    EXPECT_EQ(first.vertices, whole.mesh.vertex_count());
    EXPECT_EQ(first.triangles, whole.mesh.triangle_count());
    EXPECT_EQ(unmatched, 0);
  }
}

}  // namespace
}  // namespace vdwmesh::testing
