// opposite_half_edges(): finds for each half-edge the one that runs back along the same edge.
// EdgeBuckets groups the half-edges by edge. In a 2-manifold a group has one half-edge (boundary)
// or two that run in opposite directions; anything else is an error. Buckets are handled in
// parallel.
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "mesh/connect/edge_buckets.hpp"
#include "mesh/surface_mesh.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kVerticesPerTask = 1 << 14;

// Names the first bad edge in the bucket of v, in the order of larger vertices. Precondition:
// pair_bucket() is false for the bucket, so one of the edges is bad and the last line is not
// reached.
[[noreturn]] void throw_bad_edge(const EdgeBuckets& buckets, std::size_t v) {
  for_each_edge(buckets.at(v), [&](std::span<const EdgeEntry> edge) {
    const std::uint32_t w = edge[0].larger();
    if (edge.size() > 2)
      throw InvalidInput(fmt::format(
          "the edge of vertices {} and {} lies on {} triangles; a half-edge mesh takes two", v, w,
          edge.size()));
    if (edge.size() == 2 && edge[0].descending() == edge[1].descending())
      throw InvalidInput(fmt::format(
          "triangles {} and {} run the edge of vertices {} and {} in the same direction",
          edge[0].half_edge() / 3, edge[1].half_edge() / 3, v, w));
  });
  throw InvalidInput(fmt::format("an edge of vertex {} cannot be in a half-edge mesh", v));
}

// Makes the half-edges of each edge in a bucket each other's opposites. Returns false if an edge is
// bad: it has more than two half-edges, or two of the same direction. The caller then throws, so it
// does not matter what was written to `opposite`.
bool pair_bucket(std::span<const EdgeEntry> bucket, Buffer<std::uint32_t>& opposite) {
  bool good = true;
  for_each_edge(bucket, [&](std::span<const EdgeEntry> edge) {
    if (edge.size() == 1) {
      opposite[edge[0].half_edge()] = kNoOpposite;
      return;
    }
    good &= edge.size() == 2 && edge[0].descending() != edge[1].descending();
    opposite[edge[0].half_edge()] = edge[1].half_edge();
    opposite[edge[1].half_edge()] = edge[0].half_edge();
  });
  return good;
}

// Sets `smallest` to the minimum of itself and `value`, atomically.
void keep_smallest(std::atomic<std::size_t>& smallest, std::size_t value) {
  std::size_t seen = smallest.load();
  while (value < seen && !smallest.compare_exchange_weak(seen, value)) {
  }
}

}  // namespace

Buffer<std::uint32_t> opposite_half_edges(std::span<const Triangle> triangles,
                                          std::size_t vertex_count) {
  const EdgeBuckets buckets(triangles, vertex_count);
  if (const auto t = buckets.repeated_index())
    throw InvalidInput(fmt::format("triangle {} names a vertex twice: {} {} {}", *t,
                                   triangles[*t][0], triangles[*t][1], triangles[*t][2]));
  Buffer<std::uint32_t> opposite(3 * triangles.size());
  advise_large_pages(opposite.data(), opposite.size());
  // Buckets are disjoint, so threads never write to the same half-edge. An error is reported for
  // the smallest vertex with a bad edge in its bucket, whichever thread finds one first.
  std::atomic<std::size_t> first_bad{vertex_count};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, vertex_count, kVerticesPerTask),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t v = range.begin(); v < range.end(); ++v)
                        if (!pair_bucket(buckets.at(v), opposite)) keep_smallest(first_bad, v);
                    });
  if (first_bad < vertex_count) throw_bad_edge(buckets, first_bad);
  return opposite;
}

}  // namespace vdwmesh
