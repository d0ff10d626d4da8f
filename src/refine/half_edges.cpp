// Matching of half-edges and numbering of edges, both in linear time and on all cores.
//
// find_opposite() sorts the half-edges by start vertex with a counting sort (count, prefix sum,
// fill). The opposite of a half-edge from u to v is then the only half-edge in the bucket of v that
// ends in u. number_edges() is a prefix sum over blocks: count each block's edges, sum up the
// counts, number the edges of each block. The CUDA counterpart is cuda/refine/edge_numbers.cu.
#include "refine/half_edges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <limits>

#include "core/blocks.hpp"
#include "core/errors.hpp"

namespace vdwmesh {
namespace {

// No half-edge. Valid half-edges are lower, since at most 2^32 - 1 are allowed (kMaxHalfEdges).
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kAllGood = std::numeric_limits<std::size_t>::max();  // no half-edge is bad

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
  // After this inclusive prefix sum, begin[v] is the end of bucket v.
  std::uint32_t sum = 0;
  for (std::uint32_t& n : b.begin) n = sum += n;
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
  const std::size_t bad = reduce_all(
      opposite.size(), kAllGood,
      [&](std::size_t h, std::size_t& first) {
        if (!runs_back(mesh, opposite, h)) first = std::min(first, h);
      },
      [](std::size_t a, std::size_t b) { return std::min(a, b); });
  if (bad != kAllGood) throw_not_closed(mesh, bad);
  return opposite;
}

// The lower half-edge of each edge stands for it: half-edge h is one if h < opposite[h].
Buffer<std::uint32_t> number_edges(const Buffer<std::uint32_t>& opposite) {
  const std::size_t blocks = (opposite.size() + kBlock - 1) / kBlock;
  const auto end_of_block = [&](std::size_t b) {
    return std::min((b + 1) * kBlock, opposite.size());
  };
  Buffer<std::uint32_t> first_of_block(blocks);
  const auto count_firsts = [&](std::size_t b) {
    std::uint32_t count = 0;
    for (std::size_t h = b * kBlock; h < end_of_block(b); ++h) count += h < opposite[h];
    first_of_block[b] = count;
  };
  for_all(blocks, count_firsts, 1);
  // An exclusive prefix sum: the number of the first edge of each block.
  std::uint32_t sum = 0;
  for (std::uint32_t& n : first_of_block) {
    const std::uint32_t count = n;
    n = sum;
    sum += count;
  }
  Buffer<std::uint32_t> edge(opposite.size());
  const auto number = [&](std::size_t b) {
    std::uint32_t next = first_of_block[b];
    for (std::size_t h = b * kBlock; h < end_of_block(b); ++h) {
      // The lower half-edge writes both entries, so each entry is written once.
      if (h < opposite[h]) edge[h] = edge[opposite[h]] = next++;
    }
  };
  for_all(blocks, number, 1);
  return edge;
}

}  // namespace vdwmesh
