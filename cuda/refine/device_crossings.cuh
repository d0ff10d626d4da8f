// Search for crossing triangles of a level in device memory, with a uniform grid over the
// triangles' boxes. The grid differs from the one on the host (refine/patch_grid.hpp): its cells
// have another size and its boxes are in single precision. The triangles found are the same all the
// same, because the grids only have to bring all overlapping pairs together;
// refine/crossing_formulas.hpp decides about each in double.
#pragma once

#include <array>
#include <cstdint>

#include "cuda/memory/device_structures.cuh"
#include "cuda/refine/refine_levels.cuh"

namespace vdwmesh {

// A bounding box, Å, rounded outward to single precision. It holds a triangle with its vertices
// before and after their moves, so it holds it too if some of these moves are taken back.
struct FloatBox {
  float lower[3], upper[3];
};

__device__ inline void extend(FloatBox& box, const Vec3d& p) {
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = fminf(box.lower[axis], __double2float_rd(p[axis]));
    box.upper[axis] = fmaxf(box.upper[axis], __double2float_ru(p[axis]));
  }
}

// Writes the boxes of all triangles of a level to boxes[triangle]. One thread per patch.
template <class Level>
__global__ void bound_triangles(Level level, FloatBox* boxes) {
  const std::uint64_t patch = thread_index();
  if (patch >= level.patches()) return;
  for (int child = 0; child < Level::kTriangles; ++child) {
    FloatBox box{{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int k = 0; k < 3; ++k) {
      const int i = level.corner(child, k);
      extend(box, level.before(patch, i));
      extend(box, level.mesh.positions[level.vertex(patch, i)]);
    }
    boxes[Level::kTriangles * patch + child] = box;
  }
}

// A uniform grid, as kernels see it, with at most as many cells as triangles, or 64 if that is
// more. Each triangle is listed in every cell that its box touches. The lists are in compressed
// sparse row form: cell c lists triangles[start[c]] .. triangles[start[c + 1] - 1].
struct CrossingGrid {
  std::array<double, 3> origin;        // lower corner of cell 0, Å
  double per_length;                   // 1 / width of a cell, 1/Å
  std::array<std::uint32_t, 3> cells;  // along x, y, z
  unsigned long long* start;
  std::uint32_t* triangles;
};

class CrossingFinder {
 public:
  // Builds the grid over the boxes that bound_triangles() wrote. Throws DeviceMemoryExceeded if it
  // does not fit into device memory.
  CrossingFinder(DeviceArray<FloatBox> boxes, const Stream& stream);

  // Marks the moved vertices of all pairs of triangles that cross. `pass` counts from 0. Pairs
  // without a moved vertex are not tested: if they cross, they did so before the moves. After pass
  // 0 only pairs with a vertex that the pass before has put back are tested; no other pair has
  // changed.
  void mark(const DeviceMeshView& mesh, const MoveStatesView& move_states, int pass) const;

 private:
  void shape();
  void fill();

  const Stream& stream_;
  DeviceArray<FloatBox> boxes_;
  DeviceArray<unsigned long long> start_;
  DeviceArray<std::uint32_t> triangles_;
  CrossingGrid grid_{{0, 0, 0}, 1, {1, 1, 1}, nullptr, nullptr};
};

}  // namespace vdwmesh
