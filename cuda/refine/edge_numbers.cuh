// Numbers of a closed mesh's edges, in compressed form. The two half-edges of an edge have numbers;
// the lower one is called the edge's first half-edge. Edges are numbered from 0 in the order of
// their first half-edges. 32 half-edges share a word of 8 bytes: a bit per half-edge, which says
// whether it is the first of its edge, and the number of first half-edges in all earlier words. An
// edge's number is this count plus the number of set bits below its own. That takes 2 bits per
// half-edge instead of 32. In succinct data structures this is a bit vector with rank and select.
#pragma once

#include <cstdint>

#include "core/first_from.hpp"
#include "cuda/memory/device_memory.cuh"

namespace vdwmesh {

inline constexpr std::uint32_t kHalfEdgesPerWord = 32;

struct EdgeWord {
  std::uint32_t first;   // bit k: whether half-edge k of the word is the first of its edge
  std::uint32_t before;  // number of first half-edges in all earlier words
};

struct EdgeNumbersView {
  const EdgeWord* words;  // in device memory
  std::uint64_t count;    // how many words

  // The word of half-edge h, read by one 8-byte load.
  __device__ EdgeWord word(std::uint64_t h) const {
    const uint2 w = reinterpret_cast<const uint2*>(words)[h / kHalfEdgesPerWord];
    return {w.x, w.y};
  }
  __device__ bool is_first(std::uint64_t h) const { return (word(h).first >> (h % 32) & 1) != 0; }
  // The number of edges whose first half-edge is below h. If h itself is the first half-edge of an
  // edge, this is the number of its edge; for the second half-edge it is not.
  __device__ std::uint32_t number(std::uint64_t h) const {
    const EdgeWord w = word(h);
    return w.before + static_cast<std::uint32_t>(__popc(w.first & ((1u << (h % 32)) - 1)));
  }
  // The first half-edge of an edge, given its number: a binary search for the last word with at
  // most `edge` edges before it, then the search for the right bit of the word (__fns finds the
  // n-th set bit, n counted from 1).
  __device__ std::uint64_t half_edge(std::uint32_t edge) const {
    const std::uint64_t low = first_from(std::uint64_t{1}, count,
                                         [&](std::uint64_t i) { return words[i].before <= edge; }) -
                              1;
    const EdgeWord w = words[low];
    return kHalfEdgesPerWord * low + __fns(w.first, 0, static_cast<int>(edge - w.before + 1));
  }
};

class DeviceEdgeNumbers {
 public:
  // Numbers the edges of a mesh. `opposite` is in device memory and has for each of the
  // `half_edges` half-edges the number of the other half-edge of its edge.
  DeviceEdgeNumbers(const std::uint32_t* opposite, std::uint64_t half_edges, const Stream& stream);
  EdgeNumbersView view() const { return {words_.data(), words_.size()}; }
  // Bytes that the numbers of a mesh take.
  static std::uint64_t bytes(std::uint64_t half_edges);

 private:
  DeviceArray<EdgeWord> words_;
};

}  // namespace vdwmesh
