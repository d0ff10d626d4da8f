// Cell lists of many sets of spheres in device memory, built there.
//
// Each set has levels as a host cell list has (spheres/cell_list.hpp): spheres whose radii are
// within a factor of two share a level, and the cells of a level are about as wide as its largest
// radius. The cells of all sets and levels are numbered through, and spheres are sorted by cell,
// then by their index in the batch. A sphere's index in this order is its list place.
#pragma once

#include <cstdint>

#include "cuda/memory/device_memory.cuh"
#include "cuda/spheres/visit_level.cuh"
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
                                           std::uint32_t set, const Take& take) {
  const Vec3d reach{ball.radius, ball.radius, ball.radius};
  for (int l = 0; l < list.levels; ++l) {
    const CellFrame& frame = list.frames[set * list.levels + l];
    if (frame.level.cells[0] == 0) continue;
    if (visit_level_by_warp(frame.level, list.cell_start + frame.first_cell, ball.center - reach,
                            ball.center + reach, take)) {
      return;
    }
  }
}

}  // namespace vdwmesh::measure
