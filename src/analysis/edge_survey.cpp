#include "analysis/edge_survey.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <functional>

#include "core/disjoint_sets.hpp"
#include "core/large_pages.hpp"

namespace vdwmesh {
namespace {

constexpr std::uint32_t next_in_triangle(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }

// Corner 3t + k is that of vertex k of triangle t.
std::uint32_t corner_at_smaller(EdgeEntry e) {
  return e.descending() ? next_in_triangle(e.half_edge()) : e.half_edge();
}
std::uint32_t corner_at_larger(EdgeEntry e) {
  return e.descending() ? e.half_edge() : next_in_triangle(e.half_edge());
}

constexpr std::uint32_t previous_in_triangle(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

// What the edges say one by one.
struct EdgeCounts {
  bool closed = true, manifold = true, oriented = true;
  std::uint64_t edges = 0;

  void take(std::span<const EdgeEntry> edge) {
    ++edges;
    const auto down =
        std::count_if(edge.begin(), edge.end(), [](EdgeEntry entry) { return entry.descending(); });
    closed &= edge.size() == 2;
    manifold &= edge.size() <= 2;
    oriented &= edge.size() == 1 || 2 * static_cast<std::size_t>(down) == edge.size();
  }
  EdgeCounts operator+(const EdgeCounts& other) const {
    return {closed && other.closed, manifold && other.manifold, oriented && other.oriented,
            edges + other.edges};
  }
};

using Range = tbb::blocked_range<std::size_t>;
constexpr std::size_t kVerticesPerTask = 1 << 13;

class Surveyor {
 public:
  Surveyor(const IndexedMesh& mesh, const EdgeBuckets& buckets) : mesh_(mesh), buckets_(buckets) {}

  EdgeSurvey run() {
    const EdgeCounts counts = count_edges();
    result_.closed = counts.closed;
    result_.oriented = counts.oriented;
    result_.edges = counts.edges;
    result_.manifold = counts.manifold && !buckets_.repeated_index();
    result_.used_vertices = count_used();
    const bool every_edge_has_two_sides = result_.closed && result_.oriented && result_.manifold;
    if (every_edge_has_two_sides && has_one_fan_everywhere()) {
      number_shells_by_vertices();
    } else {
      join_across_edges();
    }
    return std::move(result_);
  }

 private:
  EdgeCounts count_edges() const {
    return tbb::parallel_reduce(
        Range(0, buckets_.vertex_count(), kVerticesPerTask), EdgeCounts{},
        [&](const Range& range, EdgeCounts counts) {
          for (std::size_t v = range.begin(); v < range.end(); ++v)
            for_each_edge(buckets_.at(v),
                          [&](std::span<const EdgeEntry> edge) { counts.take(edge); });
          return counts;
        },
        std::plus<>());
  }

  std::uint64_t count_used() const {
    Buffer<std::uint8_t> used(mesh_.vertex_count());
    std::fill(used.begin(), used.end(), std::uint8_t{0});
    for (const Triangle& triangle : mesh_.triangles)
      for (const std::uint32_t v : triangle) used[v] = 1;
    return static_cast<std::uint64_t>(std::count(used.begin(), used.end(), std::uint8_t{1}));
  }

  Buffer<std::uint32_t> pair_half_edges() const {
    Buffer<std::uint32_t> opposite;
    resize_untouched(opposite, 3 * mesh_.triangle_count());
    tbb::parallel_for(Range(0, buckets_.vertex_count(), kVerticesPerTask), [&](const Range& range) {
      for (std::size_t v = range.begin(); v < range.end(); ++v)
        for_each_edge(buckets_.at(v), [&](std::span<const EdgeEntry> edge) {
          opposite[edge[0].half_edge()] = edge[1].half_edge();
          opposite[edge[1].half_edge()] = edge[0].half_edge();
        });
    });
    return opposite;
  }

  // Whether going round each vertex from one of its corners meets all of them, where every edge has
  // two sides.
  bool has_one_fan_everywhere() const {
    const Buffer<std::uint32_t> opposite = pair_half_edges();
    constexpr std::uint32_t kNoCorner = 0xffffffffu;
    Buffer<std::uint32_t> corner;
    resize_untouched(corner, mesh_.vertex_count());
    std::fill(corner.begin(), corner.end(), kNoCorner);
    for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k) corner[mesh_.triangles[t][k]] = 3 * t + k;
    const auto met = tbb::parallel_reduce(
        Range(0, corner.size(), kVerticesPerTask), std::uint64_t{0},
        [&](const Range& range, std::uint64_t sum) {
          for (std::size_t v = range.begin(); v < range.end(); ++v) {
            if (corner[v] == kNoCorner) continue;
            std::uint32_t at = corner[v];
            do {
              ++sum;
              at = opposite[previous_in_triangle(at)];
            } while (at != corner[v]);
          }
          return sum;
        },
        std::plus<>());
    return met == 3 * static_cast<std::uint64_t>(mesh_.triangle_count());
  }

  // Triangles that meet in a vertex are connected across edges where each vertex has one fan.
  void number_shells_by_vertices() {
    DisjointSets vertices(mesh_.vertex_count());
    for (const auto& [a, b, c] : mesh_.triangles) {
      vertices.join(a, b);
      vertices.join(b, c);
    }
    constexpr std::uint32_t kNoShell = 0xffffffffu;
    Buffer<std::uint32_t> shell(mesh_.vertex_count());  // of the set that the vertex represents
    std::fill(shell.begin(), shell.end(), kNoShell);
    resize_untouched(result_.shell_of, mesh_.triangle_count());
    result_.shells = 0;
    for (std::size_t t = 0; t < mesh_.triangle_count(); ++t) {
      std::uint32_t& number = shell[vertices.find(mesh_.triangles[t][0])];
      if (number == kNoShell) number = result_.shells++;
      result_.shell_of[t] = number;
    }
  }

  // Any soup: every corner of a vertex must be reached from every other across the edges between
  // them.
  void join_across_edges() {
    DisjointSets triangles(mesh_.triangle_count()), corners(3 * mesh_.triangle_count());
    const auto join = [&](std::span<const EdgeEntry> edge) {
      for (const EdgeEntry entry : edge.subspan(1))
        triangles.join(edge[0].half_edge() / 3, entry.half_edge() / 3);
      if (edge.size() != 2) return;
      corners.join(corner_at_smaller(edge[0]), corner_at_smaller(edge[1]));
      corners.join(corner_at_larger(edge[0]), corner_at_larger(edge[1]));
    };
    for (std::size_t v = 0; v < buckets_.vertex_count(); ++v) for_each_edge(buckets_.at(v), join);
    result_.manifold = result_.manifold && corners.count() == result_.used_vertices;
    result_.shells = std::move(triangles).number_sets(result_.shell_of);
  }

  const IndexedMesh& mesh_;
  const EdgeBuckets& buckets_;
  EdgeSurvey result_{};
};

}  // namespace

EdgeSurvey survey_edges(const IndexedMesh& mesh, const EdgeBuckets& buckets) {
  return Surveyor(mesh, buckets).run();
}

}  // namespace vdwmesh
