// Sums and histograms of distances.
//
// Floating-point sums have the host's order: a warp adds up a block of distances one after another,
// in all lanes alike. Counts are integers, so atomic operations may add them in any order.
#include <algorithm>
#include <bit>

#include "cuda/distances/device_statistics.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/ordered_bits.cuh"
#include "cuda/memory/warp.cuh"

namespace vdwmesh::distance {
namespace {

constexpr unsigned kThreads = 256;
constexpr std::uint32_t kBins = static_cast<std::uint32_t>(DistanceBins::kCount);
// A block of threads of fill_bins() has a histogram of its own in shared memory, 96 KiB.
constexpr std::size_t kBinBytes = kBins * sizeof(std::uint32_t);
constexpr unsigned kBinThreads = 1024;
constexpr std::uint64_t kPerHistogram = 65536;  // distances that are worth a histogram of a block
constexpr std::uint64_t kMostHistograms = 256;

// A warp for each block. Its lanes load 32 distances at a time and pass them round.
template <class Blocks>
__global__ void sum_blocks(const double* distances, Blocks blocks, DistanceSums* sums) {
  const std::uint64_t block = thread_index() / kWarp;
  if (block >= blocks.size()) return;
  const unsigned lane = threadIdx.x % kWarp;
  const std::uint64_t end = blocks.first(block + 1);
  DistanceSums sum;
  for (std::uint64_t first = blocks.first(block); first < end; first += kWarp) {
    const double own = first + lane < end ? fabs(distances[first + lane]) : 0;
    const int count = end - first < kWarp ? static_cast<int>(end - first) : int{kWarp};
    for (int i = 0; i < count; ++i) sum.add(__shfl_sync(kAllLanes, own, i));
  }
  if (lane == 0) sums[block] = sum;
}

// Counts the distances in each bin. Thread blocks share the distances: each counts in kBins
// counters of dynamic shared memory and then adds these to `bins`.
__global__ void fill_bins(const double* distances, std::uint64_t count, unsigned long long* bins) {
  extern __shared__ std::uint32_t own[];
  for (std::uint32_t i = threadIdx.x; i < kBins; i += blockDim.x) own[i] = 0;
  __syncthreads();
  const std::uint64_t stride = static_cast<std::uint64_t>(gridDim.x) * blockDim.x;
  for (std::uint64_t i = thread_index(); i < count; i += stride) {
    atomicAdd(&own[DistanceBins::bin_of(fabs(distances[i]))], 1u);
  }
  __syncthreads();
  for (std::uint32_t i = threadIdx.x; i < kBins; i += blockDim.x) {
    if (own[i] > 0) atomicAdd(&bins[i], static_cast<unsigned long long>(own[i]));
  }
}

// A thread for each distance; an atomic operation for each warp. The bits of doubles >= 0, as
// integers, have the order of the doubles.
__global__ void find_extreme(const double* distances, std::uint64_t count,
                             unsigned long long* extreme) {
  const std::uint64_t i = thread_index();
  const double own = i < count ? fabs(distances[i]) : 0;
  const OrderedBits most = largest_of_warp(static_cast<OrderedBits>(__double_as_longlong(own)));
  if (threadIdx.x % kWarp == 0 && most > 0) atomicMax(extreme, most);
}

}  // namespace

DeviceStatistics::DeviceStatistics(const Stream& stream)
    : stream_(stream),
      bins_(zeros<unsigned long long>(kBins, stream)),
      extreme_(zeros<unsigned long long>(1, stream)) {
  check_cuda(cudaFuncSetAttribute(fill_bins, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                  static_cast<int>(kBinBytes)),
             "shared memory");
}

template <class Blocks>
void DeviceStatistics::add(const double* distances, std::uint64_t count, const Blocks& blocks) {
  const DeviceArray<DistanceSums> sums(blocks.size(), stream_);
  launch("sum_blocks", sum_blocks<Blocks>, over(blocks.size() * kWarp, kThreads), stream_,
         distances, blocks, sums.data());
  const std::uint64_t histograms =
      std::min((count + kPerHistogram - 1) / kPerHistogram, kMostHistograms);
  launch("fill_bins", fill_bins,
         LaunchShape{static_cast<unsigned>(histograms), kBinThreads, kBinBytes}, stream_, distances,
         count, bins_.data());
  const std::size_t before = blocks_.size();
  blocks_.resize(before + blocks.size());
  check_cuda(cudaMemcpyAsync(blocks_.data() + before, sums.data(), sums.bytes(),
                             cudaMemcpyDeviceToHost, stream_),
             "download");
  stream_.wait();
}
template void DeviceStatistics::add(const double*, std::uint64_t, const EvenBlocks&);
template void DeviceStatistics::add(const double*, std::uint64_t, const PatchBlocks&);

void DeviceStatistics::add_extremes(const double* distances, std::uint64_t count,
                                    std::uint64_t samples) {
  launch("find_extreme", find_extreme, over(count, kThreads), stream_, distances, count,
         extreme_.data());
  extreme_samples_ += samples;
}

double DeviceStatistics::largest() const {
  double most = 0;
  for (const DistanceSums& block : blocks_) most = std::max(most, block.max);
  return most;
}

// The extremes are a block without sums.
DistanceStatistics DeviceStatistics::result() {
  DistanceSums extremes;
  extremes.max = std::bit_cast<double>(fetch(extreme_.data(), stream_));
  extremes.samples = extreme_samples_;
  blocks_.push_back(extremes);
  std::vector<std::uint64_t> counts(kBins);
  check_cuda(
      cudaMemcpyAsync(counts.data(), bins_.data(), bins_.bytes(), cudaMemcpyDeviceToHost, stream_),
      "download");
  stream_.wait();
  DistanceHistogram histogram;
  histogram.add(counts);
  return summarize(blocks_, histogram);
}

}  // namespace vdwmesh::distance
