// A block of threads gathers the spheres near a box into shared memory, chunk by chunk, in list
// order: the order in which the CPU meets them.
#pragma once

#include <cstdint>

#include "extract/cell_list.hpp"

namespace vdwmesh {

inline constexpr unsigned kWarp = 32;
inline constexpr unsigned kAllLanes = 0xffffffffu;

// Rows of cells near a box, over all levels of the list, numbered through.
struct NearRows {
  CellRange x[CellListView::kMaxLevels], y[CellListView::kMaxLevels], z[CellListView::kMaxLevels];
  std::uint32_t first_row[CellListView::kMaxLevels + 1];
};

struct PlaceRange {
  std::uint32_t begin, end;
};

__device__ inline PlaceRange places_of_row(const CellListView& list, const NearRows& rows,
                                           std::uint32_t row) {
  int l = 0;
  while (row >= rows.first_row[l + 1]) ++l;
  const CellListView::Level& level = list.levels[l];
  const auto local = static_cast<std::int32_t>(row - rows.first_row[l]);
  const std::int32_t height = rows.y[l].last - rows.y[l].first + 1;
  const std::int32_t y = rows.y[l].first + local % height, z = rows.z[l].first + local / height;
  const std::int64_t base = (static_cast<std::int64_t>(z) * level.cells[1] + y) * level.cells[0];
  return {level.cell_start[base + rows.x[l].first], level.cell_start[base + rows.x[l].last + 1]};
}

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
  const CellRange x = cell_range(level, 0, lower.x, upper.x);
  const CellRange y = cell_range(level, 1, lower.y, upper.y);
  const CellRange z = cell_range(level, 2, lower.z, upper.z);
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

// Where a gather stands; lives in shared memory, one per block.
struct GatherState {
  NearRows rows;
  std::uint32_t next_row;    // of the batch of 32 rows in hand
  std::uint32_t next_place;  // among the places of that batch
  std::uint32_t gathered;    // in the chunk
  bool finished;
  // Of the batch: inclusive sums of the rows' lengths, and where each row ends.
  std::uint32_t sum[kWarp], end[kWarp];
  std::uint32_t kept[kWarp];  // by each warp of the block, of the last places looked at
};

// The first row of the batch whose sum exceeds `wanted`.
__device__ inline unsigned row_holding(const GatherState& state, std::uint32_t wanted) {
  unsigned owner = 0;
  for (unsigned step = kWarp / 2; step > 0; step /= 2) {
    if (state.sum[owner + step - 1] <= wanted) owner += step;
  }
  return owner;
}

// Called by all threads of the block (at least 3 * kMaxLevels of them) before the first chunk.
__device__ inline void begin_gather(const CellListView& list, const Vec3d& lower,
                                    const Vec3d& upper, GatherState& state) {
  NearRows& rows = state.rows;
  const int l = static_cast<int>(threadIdx.x) / 3, axis = static_cast<int>(threadIdx.x) % 3;
  if (l < list.level_count) {
    CellRange* range = axis == 0 ? rows.x : (axis == 1 ? rows.y : rows.z);
    range[l] = cell_range(list.levels[l], axis, lower[axis], upper[axis]);
  }
  __syncthreads();
  if (threadIdx.x == 0) {
    rows.first_row[0] = 0;
    for (int i = 0; i < list.level_count; ++i) {
      const CellRange &x = rows.x[i], &y = rows.y[i], &z = rows.z[i];
      const bool any = x.first <= x.last && y.first <= y.last && z.first <= z.last;
      const std::uint32_t count = any ? static_cast<std::uint32_t>(y.last - y.first + 1) *
                                            static_cast<std::uint32_t>(z.last - z.first + 1)
                                      : 0u;
      rows.first_row[i + 1] = rows.first_row[i] + count;
    }
    state.next_row = 0;
    state.next_place = 0;
    state.gathered = 0;
    state.finished = false;
  }
  __syncthreads();
}

// Fills the next chunk with the places for which keep(place) holds, as many places at a time as the
// block has threads; all of them call it. Afterwards state.gathered places stand in `chunk`, and
// state.finished says whether it was the last chunk. The capacity is at least one place a thread; a
// chunk ends when fewer than that are free.
template <class Keep>
__device__ void next_chunk(const CellListView& list, GatherState& state, std::uint32_t* chunk,
                           std::uint32_t capacity, Keep keep) {
  __syncthreads();
  const unsigned lane = threadIdx.x % kWarp, warp = threadIdx.x / kWarp;
  const std::uint32_t rows = state.rows.first_row[list.level_count];
  std::uint32_t row = state.next_row, skip = state.next_place, gathered = 0;
  bool full = false;
  for (; row < rows; row += kWarp) {
    if (warp == 0) {
      PlaceRange range{0, 0};
      if (row + lane < rows) range = places_of_row(list, state.rows, row + lane);
      state.sum[lane] = warp_inclusive_sum(range.end - range.begin);
      state.end[lane] = range.end;
    }
    __syncthreads();
    const std::uint32_t total = state.sum[kWarp - 1];
    for (std::uint32_t t = skip; t < total; t += blockDim.x) {
      full = gathered + blockDim.x > capacity;
      if (full) {
        skip = t;
        break;
      }
      const std::uint32_t wanted = t + threadIdx.x;
      std::uint32_t place = 0;
      bool kept = false;
      if (wanted < total) {
        const unsigned owner = row_holding(state, wanted);
        place = state.end[owner] - (state.sum[owner] - wanted);
        kept = keep(place);
      }
      const unsigned votes = __ballot_sync(kAllLanes, kept);
      if (lane == 0) state.kept[warp] = static_cast<std::uint32_t>(__popc(votes));
      __syncthreads();
      std::uint32_t before = gathered;
      for (unsigned w = 0; w < blockDim.x / kWarp; ++w) {
        if (w < warp) before += state.kept[w];
        gathered += state.kept[w];
      }
      if (kept) chunk[before + __popc(votes & ((1u << lane) - 1))] = place;
      __syncthreads();
    }
    if (full) break;
    skip = 0;
    __syncthreads();
  }
  if (threadIdx.x == 0) {
    state.next_row = row;
    state.next_place = full ? skip : 0;
    state.gathered = gathered;
    state.finished = !full;
  }
  __syncthreads();
}

}  // namespace vdwmesh
