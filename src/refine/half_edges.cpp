// Matching of half-edges and numbering of edges, both in linear time and on all cores.
//
// find_opposite() sorts the half-edges by start vertex with a counting sort (count, prefix sum,
// fill). The opposite of a half-edge from u to v is then the only half-edge in the bucket of v that
// ends in u. The CUDA counterpart of number_edges() is cuda/refine/edge_numbers.cu.
#include "refine/half_edges.hpp"

#include <fmt/format.h>

#include <atomic>
#include <limits>
#include <numeric>

#include "core/blocks.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

// No half-edge. Valid half-edges are lower, since at most 2^32 - 1 are allowed (kMaxHalfEdges).
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

std::uint32_t start_of(const IndexedMesh& mesh, std::size_t h) {
  return mesh.triangles[h / 3][h % 3];
}
std::uint32_t end_of(const IndexedMesh& mesh, std::size_t h) {
  return mesh.triangles[h / 3][(h + 1) % 3];
}

[[noreturn]] void throw_not_closed(const IndexedMesh& mesh, std::size_t h) {
  throw InvalidInput(
      fmt::format("refinement needs a closed, oriented mesh: the edge from vertex {} to vertex {} "
                  "of triangle {} is not run back by exactly one other triangle",
                  start_of(mesh, h), end_of(mesh, h), h / 3));
}

// Half-edges in buckets by start vertex, in compressed sparse rows. The order within a bucket
// depends on the threads. This does not matter, because a bucket is only asked for the one
// half-edge with a given end.
struct Buckets {
  Buffer<std::uint32_t> begin;       // by vertex: offset of its bucket; and the total
  Buffer<std::uint32_t> half_edges;  // bucket by bucket
};

Buckets fill_buckets(const IndexedMesh& mesh) {
  const std::size_t count = 3 * mesh.triangle_count();
  Buckets b;
  b.begin.assign(mesh.vertex_count() + 1, 0);
  b.half_edges.resize(count);
  for_all(count, [&](std::size_t h) {
    std::atomic_ref(b.begin[start_of(mesh, h)]).fetch_add(1, std::memory_order_relaxed);
  });
  // After this prefix sum, begin[v] is the end of bucket v.
  std::partial_sum(b.begin.begin(), b.begin.end(), b.begin.begin());
  // Each bucket is filled from its end, so begin[v] arrives at the bucket's first entry.
  for_all(count, [&](std::size_t h) {
    std::atomic_ref slot(b.begin[start_of(mesh, h)]);
    b.half_edges[slot.fetch_sub(1, std::memory_order_relaxed) - 1] = static_cast<std::uint32_t>(h);
  });
  return b;
}

// The half-edge from `from` to `to`; kNone if there is no such half-edge, or more than one.
std::uint32_t only_half_edge(const IndexedMesh& mesh, const Buckets& b, std::uint32_t from,
                             std::uint32_t to) {
  std::uint32_t found = kNone;
  for (std::uint32_t i = b.begin[from]; i < b.begin[from + 1]; ++i) {
    if (end_of(mesh, b.half_edges[i]) != to) continue;
    if (found != kNone) return kNone;
    found = b.half_edges[i];
  }
  return found;
}

Buffer<std::uint32_t> match(const IndexedMesh& mesh) {
  const Buckets buckets = fill_buckets(mesh);
  Buffer<std::uint32_t> opposite(buckets.half_edges.size());
  for_all(opposite.size(), [&](std::size_t h) {
    opposite[h] = only_half_edge(mesh, buckets, end_of(mesh, h), start_of(mesh, h));
  });
  return opposite;
}

// Whether opposite[h] is a valid opposite of half-edge h: a different half-edge with the same ends,
// the other way round, whose opposite is h again.
bool runs_back(const IndexedMesh& mesh, const Buffer<std::uint32_t>& opposite, std::size_t h) {
  const std::size_t back = opposite[h];
  return back < opposite.size() && opposite[back] == h && back != h &&
         start_of(mesh, back) == end_of(mesh, h) && end_of(mesh, back) == start_of(mesh, h);
}

}  // namespace

Buffer<std::uint32_t> find_opposite(const IndexedMesh& mesh) {
  Buffer<std::uint32_t> opposite = mesh.opposite.empty() ? match(mesh) : mesh.opposite;
  const auto bad =
      first_of_all(opposite.size(), [&](std::size_t h) { return !runs_back(mesh, opposite, h); });
  if (bad) throw_not_closed(mesh, *bad);
  return opposite;
}

// The lower half-edge of each edge stands for it: half-edge h is one if h < opposite[h].
Buffer<std::uint32_t> number_edges(const Buffer<std::uint32_t>& opposite) {
  Buffer<std::uint32_t> edge(opposite.size());
  number_all(
      opposite.size(), [&](std::size_t h) { return h < opposite[h]; },
      // The lower half-edge writes both entries, so each entry is written once.
      [&](std::size_t h, std::uint32_t number) { edge[h] = edge[opposite[h]] = number; });
  return edge;
}

}  // namespace vdwmesh
