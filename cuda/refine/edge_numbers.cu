// Builds the edge numbers: one kernel finds the first (lower) half-edge of every edge and packs 32
// answers into a word, then a prefix sum over the words counts the edges before each word.
#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>

#include "core/host_device.hpp"
#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/warp.cuh"
#include "cuda/refine/edge_numbers.cuh"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 256;

std::uint64_t words_for(std::uint64_t half_edges) {
  return (half_edges + kHalfEdgesPerWord - 1) / kHalfEdgesPerWord;
}

// Sets bit k of a word's `first` if half-edge k of the word is the lower one of its edge: if its
// opposite has a higher number. (>= asks the same, because no half-edge is its own opposite.) One
// thread per four half-edges, whose opposites it loads as one 16-byte word; eight neighbouring
// lanes combine their four bits each into a word of 32 by shuffles.
__global__ void mark_first_half_edges(const std::uint32_t* opposite, std::uint64_t half_edges,
                                      EdgeWord* words) {
  const std::uint64_t h = 4 * thread_index();
  std::uint32_t bits = 0;
  if (h + 4 <= half_edges) {
    const uint4 o = __ldcs(reinterpret_cast<const uint4*>(opposite + h));
    bits = (o.x >= h ? 1u : 0u) | (o.y >= h + 1 ? 2u : 0u) | (o.z >= h + 2 ? 4u : 0u) |
           (o.w >= h + 3 ? 8u : 0u);
  } else {
    for (std::uint64_t i = h; i < half_edges; ++i) bits |= opposite[i] >= i ? 1u << (i - h) : 0u;
  }
  const unsigned eighth = threadIdx.x % 8;
  bits <<= 4 * eighth;
  bits = joined_by_warp<4>(bits, [](std::uint32_t a, std::uint32_t b) { return a | b; });
  if (eighth == 0 && h < half_edges) words[h / kHalfEdgesPerWord].first = bits;
}

// The number of edges whose lower half-edge is in the word: what the prefix sum adds up.
struct CountFirst {
  __host__ __device__ std::uint32_t operator()(const EdgeWord& word) const {
    return static_cast<std::uint32_t>(count_bits(word.first));
  }
};

// Access to the `before` of word i. It makes a transform iterator into which the prefix sum writes.
struct BeforeOf {
  EdgeWord* words;
  __host__ __device__ std::uint32_t& operator()(std::int64_t i) const { return words[i].before; }
};

}  // namespace

DeviceEdgeNumbers::DeviceEdgeNumbers(const std::uint32_t* opposite, std::uint64_t half_edges,
                                     const Stream& stream)
    : words_(words_for(half_edges), stream.get()) {
  if (half_edges == 0) return;
  launch("mark_first_half_edges", mark_first_half_edges, over(half_edges, 4 * kThreads, kThreads),
         stream, opposite, half_edges, words_.data());
  const auto counts =
      thrust::make_transform_iterator(static_cast<const EdgeWord*>(words_.data()), CountFirst{});
  const auto before = thrust::make_transform_iterator(
      thrust::make_counting_iterator(std::int64_t{0}), BeforeOf{words_.data()});
  run_cub("scan", stream.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceScan::ExclusiveSum(scratch, bytes, counts, before,
                                         static_cast<std::int64_t>(words_.size()), stream.get());
  });
}

std::uint64_t DeviceEdgeNumbers::bytes(std::uint64_t half_edges) {
  return words_for(half_edges) * sizeof(EdgeWord);
}

}  // namespace vdwmesh
