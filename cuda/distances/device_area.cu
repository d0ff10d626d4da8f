// Adds up the areas of triangles, in the order of the host: a warp takes a block of triangles and
// adds them one after another, in all lanes alike.
#include "core/fixed_blocks.hpp"
#include "cuda/distances/device_area.cuh"
#include "cuda/memory/fetch_values.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/warp.cuh"

namespace vdwmesh::distance {
namespace {

constexpr unsigned kThreads = 256;

// Takes the triangles of a block in their order, 32 at a time, of which each lane has one. For each
// 32 of them, all lanes call add(i, the area of the triangle of lane i) for i = 0 .. 31, with an
// area of 0 for lanes beyond the end. Then each lane that has a triangle calls done(first), where
// `first` is the triangle of lane 0.
template <class Add, class Done>
__device__ void for_each_area(const SoupView& mesh, std::uint64_t block, const Add& add,
                              const Done& done) {
  const unsigned lane = threadIdx.x % kWarp;
  const std::uint64_t begin = block * kTrianglesPerAreaBlock;
  const std::uint64_t all = begin + kTrianglesPerAreaBlock;
  const std::uint64_t end = all < mesh.triangle_count ? all : mesh.triangle_count;
  for (std::uint64_t first = begin; first < end; first += kWarp) {
    const bool here = first + lane < end;
    const double own = here ? area_of(mesh(static_cast<std::uint32_t>(first + lane))) : 0;
    for (unsigned i = 0; i < kWarp; ++i) add(i, __shfl_sync(kAllLanes, own, i));
    if (here) done(first);
  }
}

// A warp for each block of triangles.
__global__ void sum_areas(SoupView mesh, std::uint32_t blocks, double* sums) {
  const std::uint64_t block = thread_index() / kWarp;
  if (block >= blocks) return;
  double sum = 0;
  for_each_area(
      mesh, block, [&](unsigned, double area) { sum += area; }, [](std::uint64_t) {});
  if (threadIdx.x % kWarp == 0) sums[block] = sum;
}

// Writes for each triangle the sum of the areas up to its end. No sum exceeds the start of the next
// block, so that they do not fall from block to block: the starts are rounded in another way. A
// warp for each block of triangles.
__global__ void find_ends(SoupView mesh, std::uint32_t blocks, const double* starts, double* ends) {
  const std::uint64_t block = thread_index() / kWarp;
  if (block >= blocks) return;
  const unsigned lane = threadIdx.x % kWarp;
  const double limit = starts[block + 1];
  double end = starts[block], own = 0;
  const auto add = [&](unsigned i, double area) {
    end = end_of_area(end, area, limit);
    if (i == lane) own = end;
  };
  for_each_area(mesh, block, add, [&](std::uint64_t first) { ends[first + lane] = own; });
}

}  // namespace

DeviceArea::DeviceArea(const SoupView& mesh, const Stream& stream) {
  const auto blocks =
      static_cast<std::uint32_t>(block_count(mesh.triangle_count, kTrianglesPerAreaBlock));
  const LaunchShape shape = over(std::uint64_t{blocks} * kWarp, kThreads);
  const DeviceArray<double> device_sums(blocks, stream);
  launch("sum_areas", sum_areas, shape, stream, mesh, blocks, device_sums.data());
  const std::vector<double> starts =
      area_block_starts(fetch_values(device_sums.data(), blocks, stream));
  total_ = starts.back();
  starts_ = upload(starts.data(), starts.size(), stream);
  ends_ = DeviceArray<double>(mesh.triangle_count, stream);
  launch("find_ends", find_ends, shape, stream, mesh, blocks, starts_.data(), ends_.data());
  stream.wait();  // the copy reads `starts`, which ends here
}

AreaView DeviceArea::view() const {
  return {starts_.data(), ends_.data(), static_cast<std::uint32_t>(ends_.size()),
          static_cast<std::uint32_t>(starts_.size() - 1)};
}

}  // namespace vdwmesh::distance
