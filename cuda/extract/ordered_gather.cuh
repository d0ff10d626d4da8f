// A warp gathers the spheres near a box in list order, as visit_near_box() visits them on the CPU,
// so that sums over them have the same bits. "Row" means a row of cells along x of one level of the
// cell list. Spheres of consecutive cells have consecutive list places, so the part of a row near
// the box is one range of list places. Each lane finds the range of one row. Then a prefix sum over
// the 32 lengths joins the ranges into one sequence, and the lanes take 32 consecutive spheres of
// it at a time. So all lanes have work, however the spheres are spread over the rows.
#pragma once

#include <cstdint>

#include "cuda/extract/extract_stages.cuh"
#include "cuda/memory/warp.cuh"

namespace vdwmesh {

struct PlaceRange {  // of list places
  std::uint32_t begin, end;
};

// Finds, by a binary search across the lanes, the row that holds element `wanted` of the sequence.
// Each lane passes its own `wanted`, and as `sum` the inclusive prefix sum at its own row. Returns
// the lane that has the row; beyond the last element the result is some lane.
__device__ inline unsigned row_holding(std::uint32_t sum, std::uint32_t wanted) {
  unsigned owner = 0;
  for (unsigned step = kWarp / 2; step > 0; step /= 2) {
    const std::uint32_t s = __shfl_sync(kAllLanes, sum, owner + step - 1);
    if (s <= wanted) owner += step;
  }
  return owner;
}

// Visits the spheres of one level of the cell list near a box, in list order, 32 at a time. All
// lanes call visit(place, valid) with a ListPlace together; `valid` is false on lanes without a
// sphere, whose `place` means nothing. If visit() returns true, the visit of the level ends. It
// must return the same on all lanes.
template <class Visit>
__device__ void visit_level_by_warp(const CellListView::Level& level, const Vec3d& lower,
                                    const Vec3d& upper, Visit&& visit) {
  const unsigned lane = threadIdx.x % kWarp;
  // Lanes 0, 1 and 2 compute the range of cells along x, y and z; then all lanes read all three.
  const int axis = static_cast<int>(lane % 3);
  const CellRange own = cell_range(level, axis, lower[axis], upper[axis]);
  const auto of_axis = [&](unsigned a) {
    return CellRange{__shfl_sync(kAllLanes, own.first, a), __shfl_sync(kAllLanes, own.last, a)};
  };
  const CellRange x = of_axis(0), y = of_axis(1), z = of_axis(2);
  if (x.first > x.last || y.first > y.last || z.first > z.last) return;
  // Row i of the box is row y.first + i % height of the cells with z = z.first + i / height.
  const std::int32_t height = y.last - y.first + 1, rows = height * (z.last - z.first + 1);
  for (std::int32_t first = 0; first < rows; first += static_cast<std::int32_t>(kWarp)) {
    const std::int32_t row = first + static_cast<std::int32_t>(lane);
    PlaceRange range{0, 0};
    if (row < rows) {
      const std::int64_t base =
          (static_cast<std::int64_t>(z.first + row / height) * level.cells[1] + y.first +
           row % height) *
          level.cells[0];
      range = {level.cell_start[base + x.first], level.cell_start[base + x.last + 1]};
    }
    const std::uint32_t sum = warp_inclusive_sum(range.end - range.begin);
    const std::uint32_t total = __shfl_sync(kAllLanes, sum, kWarp - 1);
    for (std::uint32_t t = 0; t < total; t += kWarp) {
      // Element t + lane is as far before the end of its range in the list as in the sequence.
      const unsigned owner = row_holding(sum, t + lane);
      const std::uint32_t end_place = __shfl_sync(kAllLanes, range.end, owner & (kWarp - 1));
      const std::uint32_t end_sum = __shfl_sync(kAllLanes, sum, owner & (kWarp - 1));
      const ListPlace place{end_place - (end_sum - (t + lane))};
      if (visit(place, t + lane < total)) return;
    }
  }
}

// A box relative to RoughSpheres::origin, Å.
struct RoughBox {
  float lower[3], upper[3];
};

__device__ inline RoughBox rough_box(const Vec3d& origin, const Vec3d& lower, const Vec3d& upper) {
  RoughBox box{};
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = static_cast<float>(lower[axis] - origin[axis]);
    box.upper[axis] = static_cast<float>(upper[axis] - origin[axis]);
  }
  return box;
}

// Whether a sphere of RoughSpheres may touch the box. One-sided: true for every sphere whose reach
// touches the box, and for some that just miss it.
__device__ inline bool may_reach(const RoughBox& box, const float4& sphere) {
  const float x = fmaxf(fmaxf(box.lower[0] - sphere.x, sphere.x - box.upper[0]), 0.0f);
  const float y = fmaxf(fmaxf(box.lower[1] - sphere.y, sphere.y - box.upper[1]), 0.0f);
  const float z = fmaxf(fmaxf(box.lower[2] - sphere.z, sphere.z - box.upper[2]), 0.0f);
  return fmaf(x, x, fmaf(y, y, z * z)) <= sphere.w * sphere.w;
}

// Collects, by one warp, the list places of the spheres that may reach a box, in list order, and
// hands them over in batches of `size`; the last batch has the rest. For each batch, batch(count)
// is called on all lanes, with the list places in waiting[0 .. count); the warp is synchronised
// before and after. If batch() returns true, on all lanes alike, the gathering ends. Some spheres
// of a batch do not reach the box; they contribute 0 there. One vote may add 32 places to up to
// size - 1 waiting ones, so `waiting` has size + kWarp entries. Returns how many places batch() has
// taken.
template <class Batch>
__device__ std::uint32_t gather_by_warp(const FieldContext& f, const Vec3d& lower,
                                        const Vec3d& upper, ListPlace* waiting, std::uint32_t size,
                                        Batch&& batch) {
  const CellListView& list = f.list;
  const RoughBox box = rough_box(f.rough.origin, lower, upper);
  const unsigned lane = threadIdx.x % kWarp;
  std::uint32_t count = 0, met = 0;
  bool done = false;
  // Calls batch() for the first places, and moves the others (fewer than 32) to the front.
  const auto hand_over = [&](std::uint32_t first) {
    __syncwarp();
    done = batch(first);
    __syncwarp();
    count -= first;
    met += first;
    const ListPlace next = lane < count ? waiting[first + lane] : ListPlace{};
    __syncwarp();
    if (lane < count) waiting[lane] = next;
    __syncwarp();
  };
  for (int l = 0; l < list.level_count && !done; ++l) {
    visit_level_by_warp(list.levels[l], lower, upper, [&](ListPlace place, bool valid) {
      const bool kept = valid && may_reach(box, f.rough.spheres[place]);
      const unsigned votes = __ballot_sync(kAllLanes, kept);
      // Compaction: each kept place goes behind those of the lower lanes.
      if (kept) waiting[count + bits_below(votes, lane)] = place;
      count += static_cast<std::uint32_t>(__popc(votes));
      while (count >= size && !done) hand_over(size);
      return done;  // true ends the visit and, above, the loop
    });
  }
  if (count > 0 && !done) hand_over(count);
  return met;
}

}  // namespace vdwmesh
