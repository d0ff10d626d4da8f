// Builds the cell lists of a batch: radii, extents of the levels, cells, a count for each cell, and
// a stable sort by cell. Atomic operations are minima, maxima and counts of integers, whose results
// do not depend on their order.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cub/device/device_radix_sort.cuh>
#include <limits>
#include <string>
#include <utility>

#include "core/errors.hpp"
#include "core/first_from.hpp"
#include "cuda/measure/batch_cells.cuh"
#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/ordered_bits.cuh"
#include "spheres/check_sphere.hpp"
#include "spheres/level_extent.hpp"

namespace vdwmesh::measure {
namespace {

constexpr unsigned kThreads = 256;

struct RadiusSurvey {
  OrderedBits least, largest;   // ordered
  unsigned long long rejected;  // index of the first sphere that is none
};

// What the spheres of a frame have in common, in ordered integers.
struct FrameExtent {
  OrderedBits lower[3], upper[3], reach;
  std::uint32_t spheres;
};

// A thread for each sphere of a share of the batch; one atomic operation for each warp.
__global__ void survey_radii(DeviceBatch batch, RadiusSurvey* survey) {
  OrderedBits least = kMostBits, largest = 0, rejected = kMostBits;
  const std::uint64_t stride = static_cast<std::uint64_t>(gridDim.x) * blockDim.x;
  for (std::uint64_t i = thread_index(); i < batch.size; i += stride) {
    const Sphere s = batch.spheres[i];
    if (!is_sphere(s)) rejected = min(rejected, static_cast<OrderedBits>(i));
    least = min(least, ordered(s.radius));
    largest = max(largest, ordered(s.radius));
  }
  least = least_of_warp(least);
  largest = largest_of_warp(largest);
  rejected = least_of_warp(rejected);
  if (threadIdx.x % 32 != 0) return;
  atomicMin(&survey->least, least);
  atomicMax(&survey->largest, largest);
  if (rejected != kMostBits) atomicMin(&survey->rejected, rejected);
}

// Sets every extent to an empty one. A thread for each.
__global__ void clear_extents(FrameExtent* extents, std::uint64_t count) {
  const std::uint64_t i = thread_index();
  if (i >= count) return;
  for (int axis = 0; axis < 3; ++axis) {
    extents[i].lower[axis] = kMostBits;
    extents[i].upper[axis] = 0;
  }
  extents[i].reach = 0;
  extents[i].spheres = 0;
}

__device__ std::uint32_t set_of(const DeviceBatch& batch, std::uint32_t i) {
  return first_from(std::uint32_t{1}, batch.sets,
                    [&](std::uint32_t set) { return batch.offsets[set] <= i; }) -
         1;
}

// Spheres that a thread of find_extents() takes. They stand 32 apart, so that the lanes of a warp
// always read consecutive spheres.
constexpr std::uint32_t kPerThread = 16;
// The extent of a warp's spheres. As long as they are of one frame, the warp combines them before
// it touches memory.
class ExtentSum {
 public:
  __device__ explicit ExtentSum(FrameExtent* extents) : extents_(extents) { clear(); }
  // All lanes of a warp call it; `frame` is kNoFrame for lanes without a sphere.
  static constexpr std::uint32_t kNoFrame = 0xffffffffu;
  __device__ void add(std::uint32_t frame, const Sphere& s) {
    const std::uint32_t first = __shfl_sync(kAllLanes, frame, 0);
    const bool uniform = __all_sync(kAllLanes, frame == first);
    if (!uniform || first != frame_) flush();
    frame_ = uniform ? first : kNoFrame;
    if (frame == kNoFrame) return;
    include(s);
    if (uniform) return;
    store(frame, lower_, upper_, reach_, 1);
    clear();
  }
  __device__ void flush() {
    if (frame_ == kNoFrame) return;
    OrderedBits lower[3], upper[3];
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = least_of_warp(lower_[axis]);
      upper[axis] = largest_of_warp(upper_[axis]);
    }
    const OrderedBits reach = largest_of_warp(reach_);
    const std::uint32_t count = __reduce_add_sync(kAllLanes, count_);
    if (threadIdx.x % 32 == 0) store(frame_, lower, upper, reach, count);
    frame_ = kNoFrame;
    clear();
  }

 private:
  __device__ void clear() {
    for (int axis = 0; axis < 3; ++axis) {
      lower_[axis] = kMostBits;
      upper_[axis] = 0;
    }
    reach_ = 0;
    count_ = 0;
  }
  __device__ void include(const Sphere& s) {
    const double center[3] = {s.center.x, s.center.y, s.center.z};
    for (int axis = 0; axis < 3; ++axis) {
      lower_[axis] = min(lower_[axis], ordered(center[axis]));
      upper_[axis] = max(upper_[axis], ordered(center[axis]));
    }
    reach_ = max(reach_, ordered(s.radius));
    ++count_;
  }
  __device__ void store(std::uint32_t frame, const OrderedBits* lower, const OrderedBits* upper,
                        OrderedBits reach, std::uint32_t count) {
    FrameExtent& extent = extents_[frame];
    for (int axis = 0; axis < 3; ++axis) {
      atomicMin(&extent.lower[axis], lower[axis]);
      atomicMax(&extent.upper[axis], upper[axis]);
    }
    atomicMax(&extent.reach, reach);
    atomicAdd(&extent.spheres, count);
  }

  FrameExtent* extents_;
  std::uint32_t frame_ = kNoFrame;
  OrderedBits lower_[3], upper_[3], reach_;
  std::uint32_t count_;
};

// Widens the extent of each sphere's frame by the sphere. A warp takes 32 kPerThread consecutive
// spheres. No shared memory.
__global__ void find_extents(DeviceBatch batch, double least, int levels, FrameExtent* extents) {
  const std::uint64_t warp = thread_index() / 32;
  ExtentSum sum(extents);
  for (std::uint32_t k = 0; k < kPerThread; ++k) {
    const std::uint64_t i = (warp * kPerThread + k) * 32 + threadIdx.x % 32;
    std::uint32_t frame = ExtentSum::kNoFrame;
    Sphere s{};
    if (i < batch.size) {
      s = batch.spheres[i];
      frame = set_of(batch, static_cast<std::uint32_t>(i)) * levels + level_of(s.radius, least);
    }
    sum.add(frame, s);
  }
  sum.flush();
}

// A thread for each frame: the shape of its cells. As in spheres/cell_list.cpp, cells are as wide
// as the largest radius, or wider if that would make more than `per_sphere` cells for each sphere,
// and the reach has a margin for rounding. The last thread writes a count of 0, for the prefix sum.
__global__ void shape_frames(const FrameExtent* extents, std::uint32_t count, double per_sphere,
                             CellFrame* frames, std::uint64_t* cells) {
  const std::uint64_t i = thread_index();
  if (i > count) return;
  cells[i] = 0;
  if (i == count) return;
  const FrameExtent& extent = extents[i];
  CellLevel level{};
  if (extent.spheres > 0) {
    double lower[3], size[3];
    double largest = from_ordered(extent.reach);
    level.cell_size = largest;
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = from_ordered(extent.lower[axis]);
      const double upper = from_ordered(extent.upper[axis]);
      size[axis] = upper - lower[axis];
      largest = fmax(largest, fmax(fabs(lower[axis]), fabs(upper)));
    }
    level.origin = {lower[0], lower[1], lower[2]};
    level.reach = level.cell_size + 32 * std::numeric_limits<double>::epsilon() * largest;
    const double most = fmax(1.0, per_sphere * extent.spheres);
    for (;;) {
      double along[3];
      for (int axis = 0; axis < 3; ++axis) along[axis] = floor(size[axis] / level.cell_size) + 1;
      const double total = along[0] * along[1] * along[2];
      if (total <= most) {
        for (int axis = 0; axis < 3; ++axis) level.cells[axis] = static_cast<int>(along[axis]);
        cells[i] = static_cast<std::uint64_t>(total);
        break;
      }
      level.cell_size *= fmax(1.01, cbrt(total / most));
    }
  }
  frames[i].level = level;
}

// Writes the number of each frame's first cell. A thread for each frame.
__global__ void number_cells(const std::uint64_t* first, std::uint32_t count, CellFrame* frames) {
  const std::uint64_t i = thread_index();
  if (i < count) frames[i].first_cell = static_cast<std::uint32_t>(first[i]);
}

// A thread for each sphere: finds its cell and counts it there.
__global__ void assign_cells(DeviceBatch batch, double least, int levels, const CellFrame* frames,
                             std::uint32_t* cell_of, std::uint32_t* index, std::uint32_t* counts) {
  const std::uint64_t i = thread_index();
  if (i >= batch.size) return;
  const Sphere s = batch.spheres[i];
  const std::uint32_t set = set_of(batch, static_cast<std::uint32_t>(i));
  const CellFrame& frame = frames[set * levels + level_of(s.radius, least)];
  const CellLevel& level = frame.level;
  const std::int32_t x = cell_along(level, 0, s.center.x);
  const std::int32_t y = cell_along(level, 1, s.center.y);
  const std::int32_t z = cell_along(level, 2, s.center.z);
  const std::uint32_t cell =
      frame.first_cell + (static_cast<std::uint32_t>(z) * level.cells[1] + y) * level.cells[0] + x;
  cell_of[i] = cell;
  index[i] = static_cast<std::uint32_t>(i);
  atomicAdd(&counts[cell], 1u);
}

// Writes the spheres in the order of the list, and their sets if these are asked for. A thread for
// each list place.
__global__ void gather_spheres(DeviceBatch batch, const std::uint32_t* id, Sphere* spheres,
                               std::uint32_t* sets) {
  const std::uint64_t place = thread_index();
  if (place >= batch.size) return;
  spheres[place] = batch.spheres[id[place]];
  if (sets != nullptr) sets[place] = set_of(batch, id[place]);
}

// The least and the largest radius. Throws InvalidInput if a sphere is none.
std::pair<double, double> checked_radii(const DeviceBatch& batch, const Stream& stream) {
  const RadiusSurvey start{kMostBits, 0, kMostBits};
  const DeviceArray<RadiusSurvey> survey = upload(&start, 1, stream.get());
  const unsigned blocks = std::min(blocks_for(batch.size, kThreads), 1056u);
  launch("survey_radii", survey_radii, {blocks, kThreads}, stream, batch, survey.data());
  const RadiusSurvey found = fetch(survey.data(), stream);
  if (found.rejected != kMostBits) {
    Sphere bad{};
    check_cuda(cudaMemcpy(&bad, batch.spheres + found.rejected, sizeof(bad), cudaMemcpyDefault),
               "download");
    check_sphere(bad, found.rejected);  // throws
  }
  return {from_ordered(found.least), from_ordered(found.largest)};
}

// Frames are numbered by 32 bits, of which one number means none.
std::uint32_t checked_frames(std::uint32_t sets, int levels) {
  const std::uint64_t frames = std::uint64_t{sets} * static_cast<unsigned>(levels);
  if (frames >= ExtentSum::kNoFrame) {
    throw InvalidInput(std::to_string(sets) + " sets with radii over " + std::to_string(levels) +
                       " octaves are too many for one batch: divide it");
  }
  return static_cast<std::uint32_t>(frames);
}

}  // namespace

BatchCells::BatchCells(const DeviceBatch& batch, const Stream& stream) {
  const auto [least, largest] = checked_radii(batch, stream);
  const int levels = level_of(largest, least) + 1;
  const std::uint32_t frame_count = checked_frames(batch.sets, levels);
  const DeviceArray<FrameExtent> extents(frame_count, stream);
  launch("clear_extents", clear_extents, over(frame_count, kThreads), stream, extents.data(),
         frame_count);
  launch("find_extents", find_extents, over(batch.size, kThreads * kPerThread, kThreads), stream,
         batch, least, levels, extents.data());

  frames_ = DeviceArray<CellFrame>(frame_count, stream);
  DeviceArray<std::uint64_t> first_cell(frame_count + std::size_t{1}, stream);
  // All cells together are numbered by 32 bits.
  const double per_sphere = std::min(16.0, 0x1p31 / batch.size);
  launch("shape_frames", shape_frames, over(frame_count + std::uint64_t{1}, kThreads), stream,
         extents.data(), frame_count, per_sphere, frames_.data(), first_cell.data());
  run_cub("cells", stream, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceScan::ExclusiveSum(scratch, bytes, first_cell.data(),
                                         frame_count + std::uint64_t{1}, stream.get());
  });
  launch("number_cells", number_cells, over(frame_count, kThreads), stream, first_cell.data(),
         frame_count, frames_.data());
  const std::uint64_t cells = fetch(first_cell.data() + frame_count, stream);

  cell_start_ = zeros<std::uint32_t>(cells + 1, stream);
  DeviceArray<std::uint32_t> cell_of(batch.size, stream), index(batch.size, stream);
  DeviceArray<std::uint32_t> sorted_cell(batch.size, stream);
  id_ = DeviceArray<std::uint32_t>(batch.size, stream);
  launch("assign_cells", assign_cells, over(batch.size, kThreads), stream, batch, least, levels,
         frames_.data(), cell_of.data(), index.data(), cell_start_.data());
  run_cub("cells", stream, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceScan::ExclusiveSum(scratch, bytes, cell_start_.data(), cells + 1,
                                         stream.get());
  });
  const int bits = static_cast<int>(std::bit_width(cells));
  run_cub("sort by cell", stream, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceRadixSort::SortPairs(scratch, bytes, cell_of.data(), sorted_cell.data(),
                                           index.data(), id_.data(), batch.size, 0, bits,
                                           stream.get());
  });
  spheres_ = DeviceArray<Sphere>(batch.size, stream);
  if (batch.sets > 1) set_ = DeviceArray<std::uint32_t>(batch.size, stream);
  launch("gather_spheres", gather_spheres, over(batch.size, kThreads), stream, batch, id_.data(),
         spheres_.data(), set_.data());
  view_ = {.spheres = spheres_.data(),
           .id = id_.data(),
           .set = set_.data(),
           .frames = frames_.data(),
           .cell_start = cell_start_.data(),
           .size = batch.size,
           .levels = levels};
}

}  // namespace vdwmesh::measure
