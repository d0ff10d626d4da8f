// Buckets of any soup against a sort of all half-edges, beyond one block of triangles and one range
// of vertices.
#include "mesh/connect/edge_buckets.hpp"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <random>
#include <tuple>
#include <vector>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

using ::testing::HasSubstr;

constexpr std::uint32_t kVertices = 30'000;
constexpr std::size_t kTriangles = 200'000;

std::vector<Triangle> soup(std::uint32_t vertices, std::size_t triangles) {
  std::mt19937 random(7);
  std::vector<Triangle> result(triangles);
  for (Triangle& t : result)
    for (std::uint32_t& v : t) v = static_cast<std::uint32_t>(random() % vertices);
  return result;
}

// Smaller vertex, larger vertex, half-edge, whether it descends.
using Entry = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, bool>;

std::vector<Entry> sorted_half_edges(const std::vector<Triangle>& triangles) {
  std::vector<Entry> entries;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangles[t][k], to = triangles[t][(k + 1) % 3];
      if (from != to)
        entries.push_back({std::min(from, to), std::max(from, to), 3 * t + k, from > to});
    }
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::vector<Entry> entries_of(const EdgeBuckets& buckets) {
  std::vector<Entry> entries;
  for (std::uint32_t v = 0; v < buckets.vertex_count(); ++v)
    for (const EdgeEntry e : buckets.at(v))
      entries.push_back({v, e.larger(), e.half_edge(), e.descending()});
  return entries;
}

TEST(EdgeBuckets, AnySoup) {
  // Few vertices in many triangles, as many as triangles, and nearly all of them unused.
  for (const std::uint32_t vertices : {3u, 8192u, 8193u, kVertices, 1'000'000u}) {
    SCOPED_TRACE(vertices);
    const std::vector<Triangle> triangles = soup(vertices, kTriangles);
    const std::vector<Entry> expected = sorted_half_edges(triangles);
    for (const std::size_t threads : {1u, 3u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      EXPECT_TRUE(entries_of(EdgeBuckets(triangles, vertices)) == expected) << threads;
    }
  }
}

TEST(EdgeBuckets, Nothing) {
  EXPECT_EQ(EdgeBuckets({}, 0).vertex_count(), 0u);
  const EdgeBuckets buckets({}, 3);
  EXPECT_EQ(buckets.vertex_count(), 3u);
  EXPECT_TRUE(buckets.at(2).empty());
  EXPECT_FALSE(buckets.repeated_index());
}

TEST(EdgeBuckets, TheFirstTriangleThatNamesAVertexTwice) {
  std::vector<Triangle> triangles(kTriangles, Triangle{0, 1, 2});
  EXPECT_FALSE(EdgeBuckets(triangles, 3).repeated_index());
  for (const std::size_t t : {199'999u, 150'000u, 70'000u}) {
    triangles[t] = {2, 1, 2};
    EXPECT_EQ(EdgeBuckets(triangles, 3).repeated_index(), t);
  }
}

TEST(EdgeBuckets, TheFirstTriangleThatNamesNoVertex) {
  std::vector<Triangle> triangles(kTriangles, Triangle{0, 1, 2});
  triangles[160'000] = triangles[199'999] = {0, 9, 1};
  triangles[140'000] = {1, 2, 3};
  try {
    const EdgeBuckets buckets(triangles, 3);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("triangle 140000 names vertex 3, but there are 3 vertices"));
  }
}

}  // namespace
}  // namespace vdwmesh
