// A warp gathers the spheres near a box in list order: the order in which the CPU meets them.
#pragma once

#include <cstdint>

#include "cuda/extract/extract_stages.cuh"

namespace vdwmesh {

inline constexpr unsigned kWarp = 32;
inline constexpr unsigned kAllLanes = 0xffffffffu;

struct PlaceRange {
  std::uint32_t begin, end;
};

// The row among a warp's 32 that holds place `wanted` of all their places, given the inclusive sum
// of the lengths of each lane's row; 32 beyond the last.
__device__ inline unsigned row_holding(std::uint32_t sum, std::uint32_t wanted) {
  unsigned owner = 0;
  for (unsigned step = kWarp / 2; step > 0; step /= 2) {
    const std::uint32_t s = __shfl_sync(kAllLanes, sum, owner + step - 1);
    if (s <= wanted) owner += step;
  }
  return owner;
}

__device__ inline std::uint32_t warp_inclusive_sum(std::uint32_t sum) {
  const unsigned lane = threadIdx.x % kWarp;
  for (unsigned step = 1; step < kWarp; step *= 2) {
    const std::uint32_t below = __shfl_up_sync(kAllLanes, sum, step);
    if (lane >= step) sum += below;
  }
  return sum;
}

// Calls visit(place, valid) for the spheres of a level near a box, in list order, 32 at a time: all
// lanes call it, `valid` says which of them have a sphere. Stops where it returns true.
template <class Visit>
__device__ void visit_level_by_warp(const CellListView::Level& level, const Vec3d& lower,
                                    const Vec3d& upper, Visit&& visit) {
  const unsigned lane = threadIdx.x % kWarp;
  // A lane per axis.
  const int axis = static_cast<int>(lane % 3);
  const CellRange own = cell_range(level, axis, lower[axis], upper[axis]);
  const auto of_axis = [&](unsigned a) {
    return CellRange{__shfl_sync(kAllLanes, own.first, a), __shfl_sync(kAllLanes, own.last, a)};
  };
  const CellRange x = of_axis(0), y = of_axis(1), z = of_axis(2);
  if (x.first > x.last || y.first > y.last || z.first > z.last) return;
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
      const unsigned owner = row_holding(sum, t + lane);
      const std::uint32_t end_place = __shfl_sync(kAllLanes, range.end, owner & (kWarp - 1));
      const std::uint32_t end_sum = __shfl_sync(kAllLanes, sum, owner & (kWarp - 1));
      if (visit(end_place - (end_sum - (t + lane)), t + lane < total)) return;
    }
  }
}

// A box from the origin of rough spheres, Å.
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

// Whether a sphere of that reach may touch the box: never false where it does.
__device__ inline bool may_reach(const RoughBox& box, const float4& sphere) {
  const float x = fmaxf(fmaxf(box.lower[0] - sphere.x, sphere.x - box.upper[0]), 0.0f);
  const float y = fmaxf(fmaxf(box.lower[1] - sphere.y, sphere.y - box.upper[1]), 0.0f);
  const float z = fmaxf(fmaxf(box.lower[2] - sphere.z, sphere.z - box.upper[2]), 0.0f);
  return fmaf(x, x, fmaf(y, y, z * z)) <= sphere.w * sphere.w;
}

// Collects the places of the spheres that may reach a box, in list order, by one warp; those that
// do not reach it add nothing to what is made of them. Whenever `size` of them stand in `waiting`,
// which has room for kWarp more, and at the end for the rest, it calls batch(count) for the first
// `count`; the warp is synchronised before and after. Stops where batch() returns true. Returns how
// many there were.
template <class Batch>
__device__ std::uint32_t gather_by_warp(const FieldContext& f, const Vec3d& lower,
                                        const Vec3d& upper, std::uint32_t* waiting,
                                        std::uint32_t size, Batch&& batch) {
  const CellListView& list = f.list;
  const RoughBox box = rough_box(f.rough.origin, lower, upper);
  const unsigned lane = threadIdx.x % kWarp;
  std::uint32_t count = 0, met = 0;
  bool done = false;
  const auto hand_over = [&](std::uint32_t first) {
    __syncwarp();
    done = batch(first);
    __syncwarp();
    count -= first;
    met += first;
    const std::uint32_t next = lane < count ? waiting[first + lane] : 0;
    __syncwarp();
    if (lane < count) waiting[lane] = next;
    __syncwarp();
  };
  for (int l = 0; l < list.level_count && !done; ++l) {
    visit_level_by_warp(list.levels[l], lower, upper, [&](std::uint32_t place, bool valid) {
      const bool kept = valid && may_reach(box, f.rough.spheres[place]);
      const unsigned votes = __ballot_sync(kAllLanes, kept);
      if (kept) waiting[count + __popc(votes & ((1u << lane) - 1))] = place;
      count += static_cast<std::uint32_t>(__popc(votes));
      while (count >= size && !done) hand_over(size);
      return done;
    });
  }
  if (count > 0 && !done) hand_over(count);
  return met;
}

}  // namespace vdwmesh
