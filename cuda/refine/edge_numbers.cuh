// Numbers of a closed mesh's edges, by first half-edge: a bit per half-edge and a sum per 32 of
// them instead of a number each.
#pragma once

#include <cstdint>

#include "cuda/memory/device_memory.cuh"

namespace vdwmesh {

inline constexpr std::uint32_t kHalfEdgesPerWord = 32;

struct EdgeWord {
  std::uint32_t first;   // bit k: whether half-edge k of the word is its edge's first
  std::uint32_t before;  // first half-edges before the word
};

struct EdgeNumbersView {
  const EdgeWord* words;
  std::uint64_t count;

  __device__ EdgeWord word(std::uint64_t h) const {
    const uint2 w = reinterpret_cast<const uint2*>(words)[h / kHalfEdgesPerWord];
    return {w.x, w.y};
  }
  __device__ bool is_first(std::uint64_t h) const { return (word(h).first >> (h % 32) & 1) != 0; }
  // Of the edge whose first half-edge is h; what h is not, how many edges come before it.
  __device__ std::uint32_t number(std::uint64_t h) const {
    const EdgeWord w = word(h);
    return w.before + static_cast<std::uint32_t>(__popc(w.first & ((1u << (h % 32)) - 1)));
  }
  // The first half-edge of an edge.
  __device__ std::uint64_t half_edge(std::uint32_t edge) const {
    std::uint64_t low = 0, high = count;
    while (low + 1 < high) {
      const std::uint64_t middle = low + (high - low) / 2;
      (words[middle].before <= edge ? low : high) = middle;
    }
    const EdgeWord w = words[low];
    return kHalfEdgesPerWord * low + __fns(w.first, 0, static_cast<int>(edge - w.before + 1));
  }
};

class DeviceEdgeNumbers {
 public:
  DeviceEdgeNumbers(const std::uint32_t* opposite, std::uint64_t half_edges, const Stream& stream);
  EdgeNumbersView view() const { return {words_.data(), words_.size()}; }
  // Bytes that the numbers of a mesh take.
  static std::uint64_t bytes(std::uint64_t half_edges);

 private:
  DeviceArray<EdgeWord> words_;
};

}  // namespace vdwmesh
