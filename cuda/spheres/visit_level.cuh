// A warp visits the spheres of one level of a cell list near a box, in list order, as
// visit_near_box() visits them on the CPU. "Row" means a row of cells along x. Spheres of
// consecutive cells have consecutive list places, so the part of a row near the box is one range of
// list places. Each lane finds the range of one row. Then a prefix sum over the 32 lengths joins
// the ranges into one sequence, and the lanes take 32 consecutive spheres of it at a time. So all
// lanes have work, however the spheres are spread over the rows.
#pragma once

#include <cstdint>

#include "cuda/memory/warp.cuh"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// Finds, by a binary search across the lanes, the row that holds element `wanted` of the sequence.
// Each lane passes its own `wanted`, and as `sum` the inclusive prefix sum at its own row. Returns
// the lane that has the row; beyond the last element the result is some lane.
__device__ __forceinline__ unsigned row_holding(std::uint32_t sum, std::uint32_t wanted) {
  unsigned owner = 0;
#pragma unroll
  for (unsigned step = kWarp / 2; step > 0; step /= 2) {
    const std::uint32_t s = __shfl_sync(kAllLanes, sum, owner + step - 1);
    if (s <= wanted) owner += step;
  }
  return owner;
}

// Visits 32 spheres of the level at a time. All lanes call visit(place, valid) with a ListPlace
// together; `valid` is false on lanes without a sphere, whose `place` means nothing. If visit()
// returns true, the visit of the level ends, and the function returns true. visit() must return the
// same on all lanes. `cell_start`: the list place of the first sphere of each cell, and the end of
// the level.
template <class Visit>
__device__ __forceinline__ bool visit_level_by_warp(const CellLevel& level,
                                                    const std::uint32_t* cell_start,
                                                    const Vec3d& lower, const Vec3d& upper,
                                                    const Visit& visit) {
  const unsigned lane = threadIdx.x % kWarp;
  // Lanes 0, 1 and 2 compute the range of cells along x, y and z; then all lanes read all three.
  const int axis = static_cast<int>(lane % 3);
  const CellRange own = cell_range(level, axis, lower[axis], upper[axis]);
  const auto of_axis = [&](unsigned a) {
    return CellRange{__shfl_sync(kAllLanes, own.first, a), __shfl_sync(kAllLanes, own.last, a)};
  };
  const CellRange x = of_axis(0), y = of_axis(1), z = of_axis(2);
  if (x.first > x.last || y.first > y.last || z.first > z.last) return false;
  // Row i of the box is row y.first + i % height of the cells with z = z.first + i / height.
  const std::int32_t height = y.last - y.first + 1, rows = height * (z.last - z.first + 1);
  for (std::int32_t first = 0; first < rows; first += static_cast<std::int32_t>(kWarp)) {
    const std::int32_t row = first + static_cast<std::int32_t>(lane);
    std::uint32_t begin = 0, end = 0;  // list places
    if (row < rows) {
      const std::int64_t base =
          (static_cast<std::int64_t>(z.first + row / height) * level.cells[1] + y.first +
           row % height) *
          level.cells[0];
      begin = cell_start[base + x.first];
      end = cell_start[base + x.last + 1];
    }
    const std::uint32_t sum = warp_inclusive_sum(end - begin);
    const std::uint32_t total = __shfl_sync(kAllLanes, sum, kWarp - 1);
    for (std::uint32_t t = 0; t < total; t += kWarp) {
      // Element t + lane is as far before the end of its range in the list as in the sequence.
      const unsigned owner = row_holding(sum, t + lane);
      const std::uint32_t end_place = __shfl_sync(kAllLanes, end, owner & (kWarp - 1));
      const std::uint32_t end_sum = __shfl_sync(kAllLanes, sum, owner & (kWarp - 1));
      const ListPlace place{end_place - (end_sum - (t + lane))};
      if (visit(place, t + lane < total)) return true;
    }
  }
  return false;
}

}  // namespace vdwmesh
