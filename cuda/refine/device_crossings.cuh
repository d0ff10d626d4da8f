// Triangles of a level that cross others, looked for in device memory: the uniform grid of
// refine/triangle_grid.hpp and the passes of refine/bad_moves.hpp over it.
#pragma once

#include <array>
#include <cstdint>

#include "cuda/memory/device_structures.cuh"
#include "cuda/refine/refine_levels.cuh"

namespace vdwmesh {

// Of where a triangle's vertices were and are, rounded outward: it holds the triangle whichever
// moves are taken back.
struct FloatBox {
  float lower[3], upper[3];
};

__device__ inline void extend(FloatBox& box, const Vec3d& p) {
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = fminf(box.lower[axis], __double2float_rd(p[axis]));
    box.upper[axis] = fmaxf(box.upper[axis], __double2float_ru(p[axis]));
  }
}

// The box of each triangle, by triangle; a thread per patch.
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

// A uniform grid of at most as many cells as triangles. Each triangle stands in every cell that its
// box touches.
struct CrossingGrid {
  std::array<double, 3> origin;
  double per_length;  // 1 / Å
  std::array<std::uint32_t, 3> cells;
  unsigned long long* start;  // of each cell, and the end
  std::uint32_t* triangles;   // by cell
};

class CrossingFinder {
 public:
  // Throws LimitExceeded when the grid does not fit in device memory.
  CrossingFinder(DeviceArray<FloatBox> boxes, const Stream& stream);

  // Marks the moved vertices of triangles that cross, of which one at least has moved vertices.
  // From the second pass on only a pair with a vertex that the last one took back can have come to
  // cross.
  void mark(const DeviceMeshView& mesh, const FatesView& fates, int pass) const;

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
