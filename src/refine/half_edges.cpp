// Matching of half-edges with their opposites, and numbering of edges. The loops over half-edges
// run on all cores; the short sums between them run on one.
//
// find_opposite() checks the opposites of a mesh that has them. Otherwise it finds them: it sorts
// the half-edges into buckets by start vertex with a counting sort (count, prefix sum, fill). The
// opposite of a half-edge from u to v is then the only half-edge in the bucket of v that ends in u,
// and just as well the only one before a half-edge of the bucket of u that starts in v. A search
// goes through the shorter of the two buckets. The sum of the shorter ones over all edges of a
// graph is at most the number of edges times twice its arboricity (Chiba and Nishizeki 1985), which
// is 3 for a sphere and grows with the root of the genus. So a hub of many spokes costs no more
// than other vertices.
//
// number_edges() goes over blocks of kBlock half-edges: count each block's edges, sum up the
// counts, number the edges of each block. The CUDA counterparts are
// cuda/refine/half_edges.cu and edge_numbers.cu.
#include "refine/half_edges.hpp"

#include <fmt/format.h>

#include <atomic>
#include <numeric>

#include "core/blocks.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

using Triangles = std::span<const Triangle>;

std::uint32_t start_of(Triangles triangles, std::size_t h) { return triangles[h / 3][h % 3]; }
std::uint32_t end_of(Triangles triangles, std::size_t h) { return triangles[h / 3][(h + 1) % 3]; }

// Half-edges in buckets by start vertex, as compressed sparse rows: the bucket of vertex v is
// half_edges[begin[v]] to half_edges[begin[v + 1] - 1]. The order within a bucket depends on the
// threads. This does not matter, because a bucket is only asked for the one half-edge with a given
// end.
struct Buckets {
  Buffer<std::uint32_t> begin;       // by vertex, and at the end the number of all half-edges
  Buffer<std::uint32_t> half_edges;  // bucket by bucket
};

Buckets fill_buckets(Triangles triangles, std::size_t vertices) {
  const std::size_t count = 3 * triangles.size();
  Buckets b;
  b.begin.assign(vertices + 1, 0);
  b.half_edges.resize(count);
  for_all(count, [&](std::size_t h) {
    std::atomic_ref(b.begin[start_of(triangles, h)]).fetch_add(1, std::memory_order_relaxed);
  });
  // An inclusive prefix sum: begin[v] becomes the end of bucket v. The loop is sequential; it is
  // one addition per vertex.
  std::partial_sum(b.begin.begin(), b.begin.end(), b.begin.begin());
  // Each bucket is filled from its end, so begin[v] arrives at the bucket's first entry.
  for_all(count, [&](std::size_t h) {
    std::atomic_ref slot(b.begin[start_of(triangles, h)]);
    b.half_edges[slot.fetch_sub(1, std::memory_order_relaxed) - 1] = static_cast<std::uint32_t>(h);
  });
  return b;
}

// The half-edge from `from` to `to`; kUnmatched if there is no such half-edge, or more than one. It
// starts in `from`, and the next half-edge of its triangle starts in `to`.
std::uint32_t only_half_edge(Triangles triangles, const Buckets& b, std::uint32_t from,
                             std::uint32_t to) {
  const bool before = b.begin[to + 1] - b.begin[to] < b.begin[from + 1] - b.begin[from];
  const std::uint32_t bucket = before ? to : from;
  std::uint32_t found = kUnmatched;
  for (std::uint32_t i = b.begin[bucket]; i < b.begin[bucket + 1]; ++i) {
    std::uint32_t h = b.half_edges[i];
    if (before) h = h % 3 == 0 ? h + 2 : h - 1;
    if ((before ? start_of(triangles, h) != from : end_of(triangles, h) != to)) continue;
    if (found != kUnmatched) return kUnmatched;
    found = h;
  }
  return found;
}

// Whether opposite[h] is a valid opposite of half-edge h: a different half-edge with the same ends,
// the other way round, whose opposite is h again.
bool runs_back(Triangles triangles, const Buffer<std::uint32_t>& opposite, std::size_t h) {
  const std::size_t back = opposite[h];
  return back < opposite.size() && opposite[back] == h && back != h &&
         start_of(triangles, back) == end_of(triangles, h) &&
         end_of(triangles, back) == start_of(triangles, h);
}

}  // namespace

Buffer<std::uint32_t> match_half_edges(Triangles triangles, std::size_t vertices) {
  const Buckets buckets = fill_buckets(triangles, vertices);
  Buffer<std::uint32_t> opposite(buckets.half_edges.size());
  for_all(opposite.size(), [&](std::size_t h) {
    opposite[h] = only_half_edge(triangles, buckets, end_of(triangles, h), start_of(triangles, h));
  });
  return opposite;
}

// Opposites from both sources, the mesh and match_half_edges(), pass the same test. It fails for
// kUnmatched, which is no valid index. The lowest bad half-edge is named, whichever thread finds
// it.
Buffer<std::uint32_t> find_opposite(const IndexedMesh& mesh) {
  const Triangles triangles = mesh.triangles;
  Buffer<std::uint32_t> opposite =
      mesh.opposite.empty() ? match_half_edges(triangles, mesh.vertex_count()) : mesh.opposite;
  const auto bad = first_of_all(opposite.size(),
                                [&](std::size_t h) { return !runs_back(triangles, opposite, h); });
  if (bad) throw_not_closed(triangles[*bad / 3], *bad);
  return opposite;
}

void throw_not_closed(const Triangle& triangle, std::uint64_t h) {
  throw InvalidInput(
      fmt::format("refinement needs a closed, oriented mesh: the edge from vertex {} to vertex {} "
                  "of triangle {} is not run back by exactly one other triangle",
                  triangle[h % 3], triangle[(h + 1) % 3], h / 3));
}

// Each edge is counted and numbered at the lower of its two half-edges, the half-edge h with
// h < opposite[h].
Buffer<std::uint32_t> number_edges(const Buffer<std::uint32_t>& opposite) {
  Buffer<std::uint32_t> edge(opposite.size());
  number_all(
      opposite.size(), [&](std::size_t h) { return h < opposite[h]; },
      // The lower half-edge writes both entries, so each entry is written once.
      [&](std::size_t h, std::uint32_t number) { edge[h] = edge[opposite[h]] = number; });
  return edge;
}

}  // namespace vdwmesh
