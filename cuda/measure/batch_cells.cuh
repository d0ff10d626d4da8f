// Cell lists of many sets of spheres in device memory, built there.
//
// Each set has levels as a host cell list has (spheres/cell_list.hpp): spheres whose radii are
// within a factor of two share a level, and the cells of a level are about as wide as its largest
// radius. The cells of all sets and levels are numbered through, and spheres are sorted by cell,
// then by their index in the batch. A sphere's index in this order is its list place.
#pragma once

#include <cstdint>

#include "cuda/memory/device_memory.cuh"
#include "cuda/memory/warp.cuh"
#include "spheres/cell_list.hpp"

namespace vdwmesh::measure {

// The cells of one level of one set.
struct CellFrame {
  CellLevel level;
  std::uint32_t first_cell;  // number of its first cell
};

// The cells as kernels read them. Frame number = set × levels + level.
struct BatchCellsView {
  ByListPlace<Sphere> spheres;
  ByListPlace<std::uint32_t> id;   // index in the batch
  ByListPlace<std::uint32_t> set;  // null if there is one set
  const CellFrame* frames;
  const std::uint32_t* cell_start;  // list place of the first sphere of each cell, and the end
  std::uint32_t size;
  int levels;
};

// The spheres of a batch. Set i has the spheres offsets[i] up to offsets[i + 1].
struct DeviceBatch {
  const Sphere* spheres;  // device memory, in the caller's order
  std::uint32_t size;
  const std::uint32_t* offsets;  // device memory, sets + 1
  std::uint32_t sets;
};

// The set of the ball at a list place.
__device__ inline std::uint32_t set_at(const BatchCellsView& list, ListPlace place) {
  return list.set.data() != nullptr ? list.set[place] : 0;
}

class BatchCells {
 public:
  // Throws InvalidInput with the index of the first sphere that no SphereSet would accept, and
  // DeviceMemoryExceeded. Waits for the device twice.
  BatchCells(const DeviceBatch& batch, const Stream& stream);
  const BatchCellsView& view() const { return view_; }

 private:
  DeviceArray<Sphere> spheres_;
  DeviceArray<std::uint32_t> id_, set_, cell_start_;
  DeviceArray<CellFrame> frames_;
  BatchCellsView view_{};
};

// Calls take(place, here) in all lanes at once for 32 list places after another, of which the warp
// looks at those with `here`. These are a superset of the balls of the set that overlap `ball`, in
// the same order at every call. Ends if take() returns true, which it must in all lanes alike.
template <class Take>
__device__ __forceinline__ void visit_near(const BatchCellsView& list, const Sphere& ball,
                                           std::uint32_t set, unsigned lane, const Take& take) {
  const double r = ball.radius;
  for (int l = 0; l < list.levels; ++l) {
    const CellFrame& frame = list.frames[set * list.levels + l];
    const CellLevel& level = frame.level;
    if (level.cells[0] == 0) continue;
    const CellRange rx = cell_range(level, 0, ball.center.x - r, ball.center.x + r);
    const CellRange ry = cell_range(level, 1, ball.center.y - r, ball.center.y + r);
    const CellRange rz = cell_range(level, 2, ball.center.z - r, ball.center.z + r);
    if (rx.first > rx.last || ry.first > ry.last || rz.first > rz.last) continue;
    const std::uint32_t ny = ry.last - ry.first + 1, rows = ny * (rz.last - rz.first + 1);
    for (std::uint32_t first = 0; first < rows; first += 32) {
      // A row of cells along x for each lane. Its spheres stand one after another.
      const std::uint32_t row = first + lane;
      std::uint32_t begin = 0, length = 0;
      if (row < rows) {
        const std::uint32_t z = rz.first + row / ny, y = ry.first + row % ny;
        const std::uint32_t cell = frame.first_cell + (z * level.cells[1] + y) * level.cells[0];
        begin = list.cell_start[cell + rx.first];
        length = list.cell_start[cell + rx.last + 1] - begin;
      }
      // Of the row, in the rows laid end to end.
      const std::uint32_t end = warp_inclusive_sum(length);
      const std::uint32_t total = __shfl_sync(kAllLanes, end, 31);
      const std::uint32_t shift = begin - (end - length);
      for (std::uint32_t base = 0; base < total; base += 32) {
        const std::uint32_t i = base + lane;
        int from = 0;  // the row of i: the first one that ends after i
#pragma unroll
        for (int step = 16; step > 0; step /= 2) {
          if (__shfl_sync(kAllLanes, end, from + step - 1) <= i) from += step;
        }
        const ListPlace place{i + __shfl_sync(kAllLanes, shift, from & 31)};
        if (take(place, i < total)) return;
      }
    }
  }
}

}  // namespace vdwmesh::measure
