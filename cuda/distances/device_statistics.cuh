// Statistics of distances in device memory, with the bits of the host's: sums over the same blocks
// in the same order, and a histogram of integers.
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/distances/distances_statistics.hpp"
#include "cuda/memory/device_memory.cuh"

namespace vdwmesh::distance {

// Blocks of distances that stand one after another: block b has the distances first(b) up to
// first(b + 1).
struct EvenBlocks {
  std::uint64_t count;
  std::uint32_t per_block;
  VDWMESH_HD std::uint64_t size() const { return (count + per_block - 1) / per_block; }
  VDWMESH_HD std::uint64_t first(std::uint64_t block) const {
    const std::uint64_t begin = block * per_block;
    return begin < count ? begin : count;
  }
};

// Blocks of the samples of `per_block` patches each. offsets[i] is the number of the first sample
// of patch i, less `base`; there is one offset more than patches.
struct PatchBlocks {
  const std::uint64_t* offsets;  // device memory
  std::uint64_t base;
  std::uint32_t patches, per_block;
  VDWMESH_HD std::uint64_t size() const { return (patches + per_block - 1) / per_block; }
  __device__ std::uint64_t first(std::uint64_t block) const {
    const std::uint64_t patch = block * per_block;
    return offsets[patch < patches ? patch : patches] - base;
  }
};

class DeviceStatistics {
 public:
  explicit DeviceStatistics(const Stream& stream);

  // Adds samples: `distances` has those of all blocks, whose signs are ignored. Blocks must be
  // added in the order of the host.
  template <class Blocks>
  void add(const double* distances, std::uint64_t count, const Blocks& blocks);
  // Adds `count` distances for the maximum alone; those of `samples` points, the others are 0.
  void add_extremes(const double* distances, std::uint64_t count, std::uint64_t samples);
  // The largest distance so far (Å), without those that were added for the maximum alone.
  double largest() const;
  // Waits for the device.
  DistanceStatistics result();

 private:
  const Stream& stream_;
  std::vector<DistanceSums> blocks_;
  DeviceArray<unsigned long long> bins_;
  DeviceArray<unsigned long long> extreme_;  // the bits of the largest distance
  std::uint64_t extreme_samples_ = 0;
};

}  // namespace vdwmesh::distance
