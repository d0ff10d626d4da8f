// Builds a cell list on the device, in the steps of CellList::rebuild(): the extents of the levels,
// from which the host makes their cells (frame_of()), if these are not given; the canonical order,
// by a merge sort with the comparison of canonical_order(); and a stable sort of the spheres in
// that order by cell. So every list place holds the sphere that it holds on the host.
#include <algorithm>
#include <bit>
#include <cub/device/device_merge_sort.cuh>
#include <cub/device/device_radix_sort.cuh>
#include <string>

#include "core/buffer.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/ordered_bits.cuh"
#include "cuda/memory/transfer.cuh"
#include "cuda/spheres/device_frames.cuh"
#include "extract/blended/field_formulas.hpp"
#include "extract/field_list.hpp"
#include "spheres/frame_fit.hpp"
#include "spheres/level_extent.hpp"

namespace vdwmesh {
namespace {

// With fewer spheres, the host makes the list in less time than the launches of the many small
// kernels take.
constexpr std::size_t kSpheresWorthBuilding = 8192;

constexpr unsigned kThreads = 256;
constexpr unsigned kMostBlocks = 264;  // two for each multiprocessor of an H200
constexpr int kMostLevels = CellListView::kMaxLevels;

// A LevelExtent in ordered bits. It has no constructor, because it stands in shared memory.
struct LevelBits {
  OrderedBits lower[3], upper[3], reach;
  unsigned long long spheres;

  __device__ void add(const LevelBits& other) {
    for (int axis = 0; axis < 3; ++axis) {
      atomicMin(&lower[axis], other.lower[axis]);
      atomicMax(&upper[axis], other.upper[axis]);
    }
    atomicMax(&reach, other.reach);
    atomicAdd(&spheres, other.spheres);
  }
};
constexpr LevelBits kNoSpheres{{kMostBits, kMostBits, kMostBits}, {0, 0, 0}, 0, 0};
struct LevelSurvey {
  LevelBits levels[kMostLevels];
};

// The spheres of a list, and the reach by which they are sorted into levels.
struct ListedSpheres {
  const Sphere* spheres;
  std::uint32_t size;
  FieldModel model;
  double smallest_reach;

  __device__ double reach(std::uint32_t i) const { return field_reach(model, spheres[i].radius); }
};

// A thread for each sphere of a share of them. A block joins what it found in shared memory.
__global__ void survey_levels(ListedSpheres list, LevelSurvey* survey) {
  __shared__ LevelBits own[kMostLevels];
  if (threadIdx.x < kMostLevels) own[threadIdx.x] = kNoSpheres;
  __syncthreads();
  const std::uint32_t step = gridDim.x * blockDim.x;
  for (std::uint64_t i = thread_index(); i < list.size; i += step) {
    const auto number = static_cast<std::uint32_t>(i);
    const Vec3d& c = list.spheres[number].center;
    const double reach = list.reach(number);
    LevelBits sphere = kNoSpheres;
    for (int axis = 0; axis < 3; ++axis) sphere.lower[axis] = sphere.upper[axis] = ordered(c[axis]);
    sphere.reach = ordered(reach);
    sphere.spheres = 1;
    own[level_of(reach, list.smallest_reach)].add(sphere);
  }
  __syncthreads();
  if (threadIdx.x < kMostLevels && own[threadIdx.x].spheres > 0) {
    survey->levels[threadIdx.x].add(own[threadIdx.x]);
  }
}

// Adding 0 turns -0 into 0, so that an extent does not depend on the order of equal numbers.
LevelExtent extent_of(const LevelBits& bits) {
  LevelExtent extent;
  extent.spheres = bits.spheres;
  if (bits.spheres == 0) return extent;
  for (int axis = 0; axis < 3; ++axis) {
    extent.centers.lower[axis] = from_ordered(bits.lower[axis]) + 0.0;
    extent.centers.upper[axis] = from_ordered(bits.upper[axis]) + 0.0;
  }
  extent.reach = from_ordered(bits.reach);
  return extent;
}

CellListFrame make_frame_on_device(const ListedSpheres& list, const Stream& stream) {
  LevelSurvey start;
  std::ranges::fill(start.levels, kNoSpheres);
  const DeviceArray<LevelSurvey> survey = upload(&start, 1, stream);
  launch("survey_levels", survey_levels,
         {std::min(blocks_for(list.size, kThreads), kMostBlocks), kThreads}, stream, list,
         survey.data());
  const LevelSurvey found = fetch(survey.data(), stream);
  LevelExtent extents[kMostLevels];
  std::ranges::transform(found.levels, extents, extent_of);
  return frame_of(extents, list.smallest_reach);
}

// The cells of all levels, numbered through; passed to kernels by value.
struct LevelTable {
  CellLevel level[kMostLevels];
  std::uint32_t first_cell[kMostLevels];
};

// Throws LimitExceeded if 32 bits do not suffice to number the cells.
std::uint32_t number_cells(const CellListFrame& frame, LevelTable& table) {
  std::uint64_t cells = 0;
  for (std::size_t l = 0; l < frame.levels.size(); ++l) {
    table.level[l] = frame.levels[l];
    table.first_cell[l] = static_cast<std::uint32_t>(cells);
    cells += cell_count(frame.levels[l]);
  }
  if (cells < kNoSphere) return static_cast<std::uint32_t>(cells);
  throw LimitExceeded("a cell list of " + std::to_string(cells) + " cells does not fit a device");
}

// A sphere in the canonical order: as on the host, most comparisons need x only.
struct OrderKey {
  double x;
  SphereId id;
};

// A thread for each sphere, in the caller's order.
__global__ void make_keys(ListedSpheres list, OrderKey* keys) {
  const std::uint64_t i = thread_index();
  if (i < list.size) keys[i] = {list.spheres[i].center.x, static_cast<SphereId>(i)};
}

// A thread for each rank: finds the sphere's cell and counts it there.
__global__ void find_cells(ListedSpheres list, LevelTable table, const OrderKey* order,
                           std::uint32_t* cell_of, Rank* rank, std::uint32_t* counts) {
  const std::uint64_t i = thread_index();
  if (i >= list.size) return;
  const SphereId id = order[i].id;
  const int level = level_of(list.reach(id), list.smallest_reach);
  const std::uint32_t cell =
      table.first_cell[level] + cell_index(table.level[level], list.spheres[id].center);
  cell_of[i] = cell;
  rank[i] = static_cast<Rank>(i);
  atomicAdd(&counts[cell], 1u);
}

// A thread for each list place, whose rank is known.
__global__ void place_spheres(ListedSpheres list, const OrderKey* order, const Rank* rank,
                              SphereId* ids, Sphere* spheres) {
  const std::uint64_t place = thread_index();
  if (place >= list.size) return;
  ids[place] = order[to_index(rank[place])].id;
  spheres[place] = list.spheres[ids[place]];
}

DeviceArray<OrderKey> canonical_keys(const ListedSpheres& list, const Stream& stream) {
  DeviceArray<OrderKey> keys(list.size, stream);
  launch("make_keys", make_keys, over(list.size, kThreads), stream, list, keys.data());
  const auto comes_before = [spheres = list.spheres] __device__(const OrderKey& a,
                                                                const OrderKey& b) -> bool {
    if (a.x != b.x) return a.x < b.x;
    const Sphere &s = spheres[a.id], &t = spheres[b.id];
    if (s.center.y != t.center.y) return s.center.y < t.center.y;
    if (s.center.z != t.center.z) return s.center.z < t.center.z;
    return s.radius != t.radius ? s.radius < t.radius : a.id < b.id;
  };
  run_cub("canonical order", stream, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceMergeSort::SortKeys(scratch, bytes, keys.data(), list.size, comes_before,
                                          stream.get());
  });
  return keys;
}

// The list's view; levels without spheres are not in it. A level ends where the next one that has
// cells begins, so the cells of all levels can share one array of starts.
CellListView view_of(const CellListFrame& frame, const LevelTable& table,
                     const std::uint32_t* cell_start) {
  CellListView view{};
  for (std::size_t l = 0; l < frame.levels.size(); ++l) {
    if (frame.levels[l].cells[0] == 0) continue;
    CellListView::Level& level = view.levels[view.level_count++];
    static_cast<CellLevel&>(level) = frame.levels[l];
    level.cell_start = cell_start + table.first_cell[l];
  }
  return view;
}

}  // namespace

ListToUpload prepare_list(const SphereSet& spheres, const FieldModel& model,
                          const CellListFrame* frame, Workspace& workspace) {
  if (spheres.size() < kSpheresWorthBuilding) {
    return {spheres, field_list(spheres, model, frame, workspace), frame};
  }
  if (frame != nullptr) {
    require_fit(*frame, spheres, field_reaches(spheres, model));
  }
  return {spheres, {}, frame};
}

DeviceCellList upload_list(const ListToUpload& list, const FieldModel& model,
                           const Stream& stream) {
  if (list.list) return {*list.list, stream.get()};
  const std::span<const Sphere> host = list.spheres.spheres();
  const double least = join_blocks(
      host.size(),
      [&](std::size_t first, std::size_t end) {
        return std::ranges::min(host.subspan(first, end - first), {}, &Sphere::radius).radius;
      },
      [](double& total, double part) { total = std::min(total, part); });
  const DeviceArray<Sphere> copy(host.size(), stream.get());
  upload_parts({{copy.data(), host.data(), copy.bytes()}}, stream);
  return build_cell_list(copy.data(), host.size(), least, model, stream, list.frame);
}

DeviceCellList build_cell_list(const Sphere* source, std::size_t count, double least_radius,
                               const FieldModel& model, const Stream& stream,
                               const CellListFrame* given) {
  const auto size = static_cast<std::uint32_t>(count);
  // field_reach() does not fall as the radius grows, so the least radius has the smallest reach.
  const double smallest = given ? given->smallest_reach : field_reach(model, least_radius);
  const ListedSpheres list{source, size, model, smallest};
  const CellListFrame frame = given ? *given : make_frame_on_device(list, stream);
  LevelTable table{};
  const std::uint32_t cells = number_cells(frame, table);

  const DeviceArray<OrderKey> order = canonical_keys(list, stream);
  DeviceArray<std::uint32_t> cell_start = zeros<std::uint32_t>(cells + std::size_t{1}, stream);
  const DeviceArray<std::uint32_t> cell_of(size, stream), sorted_cell(size, stream);
  const DeviceArray<Rank> ranks(size, stream);
  launch("find_cells", find_cells, over(size, kThreads), stream, list, table, order.data(),
         cell_of.data(), ranks.data(), cell_start.data());
  run_cub("cells", stream, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceScan::ExclusiveSum(scratch, bytes, cell_start.data(), cells + std::size_t{1},
                                         stream.get());
  });
  DeviceArray<Rank> rank(size, stream);
  run_cub("sort by cell", stream, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceRadixSort::SortPairs(scratch, bytes, cell_of.data(), sorted_cell.data(),
                                           ranks.data(), rank.data(), size, 0,
                                           std::bit_width(cells), stream.get());
  });
  DeviceArray<SphereId> ids(size, stream);
  DeviceArray<Sphere> spheres(size, stream);
  launch("place_spheres", place_spheres, over(size, kThreads), stream, list, order.data(),
         rank.data(), ids.data(), spheres.data());
  CellListView view = view_of(frame, table, cell_start.data());
  view.spheres = spheres.data();
  view.rank = rank.data();
  view.id = ids.data();
  view.size = size;
  return {std::move(spheres), std::move(rank), std::move(ids), std::move(cell_start), view};
}

}  // namespace vdwmesh
