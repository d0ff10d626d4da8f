// Matches half-edges with their opposites by a counting sort, as the host does: half-edges in
// buckets by start vertex, and the opposite of one from u to v is the only half-edge in the bucket
// of v that ends in u, or the one before a half-edge of the bucket of u that starts in v; the
// shorter bucket is searched. The order within a bucket depends on the threads, but nothing else
// does.
#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/refine/half_edges.cuh"
#include "refine/half_edges.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 256;

struct HalfEdges {
  const std::uint32_t* corners;
  std::uint64_t count;

  __device__ std::uint32_t start(std::uint64_t h) const { return corners[h]; }
  __device__ std::uint32_t end(std::uint64_t h) const {
    return corners[h % 3 == 2 ? h - 2 : h + 1];
  }
};

// Counts the half-edges of each bucket.
__global__ void count_starts(HalfEdges all, std::uint32_t* counts) {
  const std::uint64_t h = thread_index();
  if (h < all.count) atomicAdd(&counts[all.start(h)], 1u);
}

// Fills each bucket from its end, so that ends[v], the end of bucket v, arrives at its beginning.
__global__ void fill_buckets(HalfEdges all, std::uint32_t* ends, std::uint32_t* buckets) {
  const std::uint64_t h = thread_index();
  if (h >= all.count) return;
  buckets[atomicSub(&ends[all.start(h)], 1u) - 1] = static_cast<std::uint32_t>(h);
}

// A thread for each half-edge. begin[v + 1] is where the bucket of v ends.
__global__ void match_half_edges(HalfEdges all, const std::uint32_t* begin,
                                 const std::uint32_t* buckets, std::uint32_t* opposite) {
  const std::uint64_t h = thread_index();
  if (h >= all.count) return;
  const std::uint32_t from = all.end(h), to = all.start(h);
  const bool before = begin[to + 1] - begin[to] < begin[from + 1] - begin[from];
  const std::uint32_t bucket = before ? to : from;
  std::uint32_t found = kUnmatched;
  for (std::uint32_t i = begin[bucket]; i < begin[bucket + 1]; ++i) {
    std::uint32_t candidate = buckets[i];
    if (before) candidate = candidate % 3 == 0 ? candidate + 2 : candidate - 1;
    if (before ? all.start(candidate) != from : all.end(candidate) != to) continue;
    if (found != kUnmatched) {
      found = kUnmatched;
      break;
    }
    found = candidate;
  }
  opposite[h] = found;
}

// Finds the lowest half-edge whose opposite does not come back to it. The ends of both are the same
// by the search of match_half_edges().
__global__ void find_first_bad(const std::uint32_t* opposite, std::uint64_t count,
                               unsigned long long* first_bad) {
  const std::uint64_t h = thread_index();
  if (h >= count) return;
  const std::uint32_t back = opposite[h];
  if (back == kUnmatched || back == h || opposite[back] != h)
    atomicMin(first_bad, static_cast<unsigned long long>(h));
}

}  // namespace

DeviceArray<std::uint32_t> find_opposite_on_device(const DeviceMeshView& mesh,
                                                   const Stream& stream) {
  const HalfEdges all{mesh.corners, 3 * mesh.triangles};
  DeviceArray<std::uint32_t> opposite(all.count, stream.get());
  if (all.count == 0) return opposite;
  {
    const auto begin = zeros<std::uint32_t>(mesh.vertices + 1, stream.get());
    const DeviceArray<std::uint32_t> buckets(all.count, stream.get());
    const LaunchShape shape = over(all.count, kThreads);
    launch("count_starts", count_starts, shape, stream.get(), all, begin.data());
    run_cub("scan", stream.get(), [&](void* scratch, std::size_t& bytes) {
      return cub::DeviceScan::InclusiveSum(scratch, bytes, begin.data(), begin.data(),
                                           static_cast<std::int64_t>(begin.size()), stream.get());
    });
    launch("fill_buckets", fill_buckets, shape, stream.get(), all, begin.data(), buckets.data());
    launch("match_half_edges", match_half_edges, shape, stream.get(), all, begin.data(),
           buckets.data(), opposite.data());
  }
  const unsigned long long none = ~0ull;
  const DeviceArray<unsigned long long> bad = upload(&none, 1, stream.get());
  launch("find_first_bad", find_first_bad, over(all.count, kThreads), stream.get(), opposite.data(),
         all.count, bad.data());
  const std::uint64_t first_bad = fetch(bad.data(), stream);
  if (first_bad != none) {
    const auto* const rows = reinterpret_cast<const Triangle*>(mesh.corners);
    throw_not_closed(fetch(rows + first_bad / 3, stream), first_bad);
  }
  return opposite;
}

}  // namespace vdwmesh
