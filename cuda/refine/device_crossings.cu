// Finds crossing triangles with a uniform grid of cells. The grid is built in these steps: extent
// of all boxes, width of the cells, number of entries per cell, prefix sum, entries. An entry is a
// triangle in the list of a cell.
//
// Then the pairs of triangles that share a cell are tested. A pair that shares several cells is
// tested in one of them only: the cell that holds the lower corner of the intersection of the two
// boxes. This is the reference point method of spatial joins (Dittrich and Seeger, ICDE 2000).
#include <thrust/iterator/transform_iterator.h>

#include <algorithm>
#include <cmath>
#include <cub/device/device_reduce.cuh>
#include <limits>
#include <utility>

#include "cuda/memory/cub_calls.cuh"
#include "cuda/refine/device_crossings.cuh"
#include "refine/crossing_formulas.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 256;

// ---- the grid ----

struct Extent {
  FloatBox all;      // holds all boxes
  double width_sum;  // the sum, over the boxes, of the longest side of each, Å
};

// The extent of no box: joined with any extent, it gives that extent.
constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr Extent kNoExtent{{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}}, 0};

// The extent of a single box.
struct ExtentOf {
  __host__ __device__ Extent operator()(const FloatBox& box) const {
    double width = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double along = static_cast<double>(box.upper[axis]) - box.lower[axis];
      width = along > width ? along : width;
    }
    return {box, width};
  }
};

// The extent of two groups of boxes together.
struct JoinExtents {
  __host__ __device__ Extent operator()(Extent a, const Extent& b) const {
    for (int axis = 0; axis < 3; ++axis) {
      a.all.lower[axis] = fminf(a.all.lower[axis], b.all.lower[axis]);
      a.all.upper[axis] = fmaxf(a.all.upper[axis], b.all.upper[axis]);
    }
    a.width_sum += b.width_sum;
    return a;
  }
};

// The number of cells of width `cell` that the box spans along an axis.
double cells_along(const FloatBox& all, double cell, int axis) {
  return std::floor((static_cast<double>(all.upper[axis]) - all.lower[axis]) / cell) + 1;
}

// The index, along one axis, of the cell that holds the coordinate, clamped to the grid. Rounding
// keeps the order of coordinates: a larger one never gets a lower index. So if two boxes have a
// point in common, the cell of that point is in the range of cells of both, and both are listed in
// it.
__device__ std::uint32_t cell_along(const CrossingGrid& grid, int axis, float coordinate) {
  const double place = (coordinate - grid.origin[axis]) * grid.per_length;
  return static_cast<std::uint32_t>(fmin(fmax(place, 0.0), grid.cells[axis] - 1.0));
}

// The position of a cell in the grid, as its index along each axis.
struct Place {
  std::uint32_t along[3];
};

__device__ Place place_of(const CrossingGrid& grid, const float* corner) {
  return {cell_along(grid, 0, corner[0]), cell_along(grid, 1, corner[1]),
          cell_along(grid, 2, corner[2])};
}

// Calls visit(cell, place) for every cell that the box touches, with the cell's number and
// position.
template <class Visit>
__device__ void visit_cells(const CrossingGrid& grid, const FloatBox& box, const Visit& visit) {
  const Place low = place_of(grid, box.lower), high = place_of(grid, box.upper);
  for (std::uint64_t z = low.along[2]; z <= high.along[2]; ++z) {
    for (std::uint64_t y = low.along[1]; y <= high.along[1]; ++y) {
      const std::uint64_t row = (z * grid.cells[1] + y) * grid.cells[0];
      for (std::uint64_t x = low.along[0]; x <= high.along[0]; ++x) {
        visit(row + x, Place{{static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                              static_cast<std::uint32_t>(z)}});
      }
    }
  }
}

// Counts the entries of every cell in grid.start, which begins as zeros. One thread per triangle.
__global__ void count_entries(CrossingGrid grid, const FloatBox* boxes, std::uint64_t triangles) {
  const std::uint64_t t = thread_index();
  if (t >= triangles) return;
  visit_cells(grid, boxes[t],
              [&](std::uint64_t cell, Place) { atomicAdd(&grid.start[cell], 1ull); });
}

// Writes the entries. One thread per triangle. When the kernel begins, start[c] is the end of cell
// c's list (an inclusive prefix sum of the counts). Each list is filled from its end and start[c]
// decreased, so that in the end it is the list's first entry. The order within a list depends on
// the scheduling of threads; the marks of vertices do not.
__global__ void fill_cells(CrossingGrid grid, const FloatBox* boxes, std::uint64_t triangles) {
  const std::uint64_t t = thread_index();
  if (t >= triangles) return;
  visit_cells(grid, boxes[t], [&](std::uint64_t cell, Place) {
    // Adding ~0 subtracts one; the result is the value before.
    const unsigned long long behind = atomicAdd(&grid.start[cell], ~0ull);
    grid.triangles[behind - 1] = static_cast<std::uint32_t>(t);
  });
}

// ---- crossings ----

// The corners of a triangle.
struct Corners {
  std::uint32_t vertex[3];
  Vec3d position[3];
  SphereId atom[3];
};

__device__ void load_vertices(const DeviceMeshView& mesh, std::uint64_t t, std::uint32_t* vertex) {
  for (int k = 0; k < 3; ++k) vertex[k] = mesh.corners[3 * t + k];
}

__device__ void load_places(const DeviceMeshView& mesh, Corners& c) {
  for (int k = 0; k < 3; ++k) {
    c.position[k] = mesh.positions[c.vertex[k]];
    c.atom[k] = mesh.vertex_spheres.atoms[c.vertex[k]];
  }
}

// away: whether a vertex of the triangle is where its move led. just_undone: whether one was put
// back by the previous pass.
struct TriangleState {
  bool away, just_undone;
};

__device__ TriangleState state_of(const MoveStatesView& move_states, const std::uint32_t* vertex) {
  TriangleState triangle{false, false};
  for (int k = 0; k < 3; ++k) {
    const MoveState state = move_states.of(vertex[k]);
    triangle.away |= state == MoveState::moved || state == MoveState::to_undo;
    triangle.just_undone |= state == MoveState::just_undone;
  }
  return triangle;
}

// Whether two boxes have a point in common.
__device__ bool overlap(const FloatBox& a, const FloatBox& b) {
  bool apart = false;
  for (int axis = 0; axis < 3; ++axis) {
    apart |= a.lower[axis] > b.upper[axis] || b.lower[axis] > a.upper[axis];
  }
  return !apart;
}

// Whether the pair of triangles with boxes a and b is to be tested in the cell at `place`, one of
// the cells that both touch: whether this cell holds the lower corner of the boxes' intersection.
// Precondition: the boxes overlap.
__device__ bool is_first_shared(const CrossingGrid& grid, const Place& place, const FloatBox& a,
                                const FloatBox& b) {
  bool first = true;
  for (int axis = 0; axis < 3; ++axis) {
    const float corner = fmaxf(a.lower[axis], b.lower[axis]);
    first &= cell_along(grid, axis, corner) == place.along[axis];
  }
  return first;
}

__device__ bool is_crossing(const Corners& a, const Corners& b) {
  return boxes_overlap(a.position, b.position) &&
         triangles_cross(a.position, a.vertex, a.atom, b.position, b.vertex, b.atom);
}

// Marks the moved vertices of crossing triangles. One thread per triangle, which tests its own
// triangle against the others in its cells. In pass 0 it tests only triangles with a higher number
// than its own, so each pair is tested once. In later passes it tests all others, but only if a
// vertex of its own triangle was put back by the previous pass. Pairs without a moved vertex are
// not tested. Other threads may mark vertices meanwhile: a marked vertex still counts as away, so
// the result does not depend on their order.
__global__ void mark_crossed(CrossingGrid grid, const FloatBox* boxes, DeviceMeshView mesh,
                             MoveStatesView move_states, int pass) {
  const std::uint64_t t = thread_index();
  if (t >= mesh.triangles) return;
  Corners mine;
  load_vertices(mesh, t, mine.vertex);
  const TriangleState state = state_of(move_states, mine.vertex);
  if (pass > 0 && !state.just_undone) return;
  load_places(mesh, mine);
  const FloatBox box = boxes[t];
  visit_cells(grid, box, [&](std::uint64_t cell, const Place& place) {
    for (unsigned long long e = grid.start[cell]; e < grid.start[cell + 1]; ++e) {
      const std::uint32_t other = grid.triangles[e];
      if (pass == 0 ? other <= t : other == t) continue;
      const FloatBox other_box = boxes[other];
      if (!overlap(box, other_box) || !is_first_shared(grid, place, box, other_box)) continue;
      Corners theirs;
      load_vertices(mesh, other, theirs.vertex);
      if (!state.away && !state_of(move_states, theirs.vertex).away) continue;
      load_places(mesh, theirs);
      if (!is_crossing(mine, theirs)) continue;
      for (int k = 0; k < 3; ++k) {
        move_states.mark(mine.vertex[k]);
        move_states.mark(theirs.vertex[k]);
      }
    }
  });
}

}  // namespace

CrossingFinder::CrossingFinder(DeviceArray<FloatBox> boxes, const Stream& stream)
    : stream_(stream), boxes_(std::move(boxes)) {
  if (boxes_.size() == 0) return;
  shape();
  fill();
}

// Chooses origin, width and number of the cells. A cell is as wide as the longest side of a box is
// on average, so that a triangle is listed in a few cells. If this gives more cells than triangles
// (or than 64, or than 32 bits number), the width grows by the cube root of the excess, and by 1 %
// at least, until the cells are few enough.
void CrossingFinder::shape() {
  const DeviceArray<Extent> total(1, stream_.get());
  const auto extents =
      thrust::make_transform_iterator(static_cast<const FloatBox*>(boxes_.data()), ExtentOf{});
  run_cub("extent of the triangles", stream_.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceReduce::Reduce(scratch, bytes, extents, total.data(),
                                     static_cast<std::int64_t>(boxes_.size()), JoinExtents{},
                                     kNoExtent, stream_.get());
  });
  const Extent extent = fetch(total.data(), stream_);
  const auto triangles = static_cast<double>(boxes_.size());
  const double most =
      std::clamp(triangles, 64.0, double{std::numeric_limits<std::uint32_t>::max()});
  // The bound of 1e-100 Å avoids a division by zero if all triangles are points.
  double cell = std::max(extent.width_sum / triangles, 1e-100);
  for (;;) {
    double cells = 1;
    for (int axis = 0; axis < 3; ++axis) cells *= cells_along(extent.all, cell, axis);
    if (cells <= most) break;
    cell *= std::max(1.01, std::cbrt(cells / most));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid_.origin[axis] = extent.all.lower[axis];
    grid_.cells[axis] =
        static_cast<std::uint32_t>(cells_along(extent.all, cell, static_cast<int>(axis)));
  }
  grid_.per_length = 1 / cell;
}

// Takes the memory of the grid, after checking that it is there, and writes the entries. The array
// `start` has one element per cell and one more, which stays 0 while counting and is the number of
// all entries after the prefix sum.
void CrossingFinder::fill() {
  const std::uint64_t cells = std::uint64_t{grid_.cells[0]} * grid_.cells[1] * grid_.cells[2];
  const char* const purpose = "looking for crossing triangles";
  require_device_memory((cells + 1) * sizeof(unsigned long long), purpose);
  start_ = DeviceArray<unsigned long long>(cells + 1, stream_.get());
  clear(start_, stream_.get());
  grid_.start = start_.data();
  const std::uint64_t triangles = boxes_.size();
  launch("count_entries", count_entries, over(triangles, kThreads), stream_, grid_, boxes_.data(),
         triangles);
  run_cub("scan of the cells", stream_.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceScan::InclusiveSum(scratch, bytes, start_.data(), start_.data(),
                                         static_cast<std::int64_t>(cells + 1), stream_.get());
  });
  const std::uint64_t entries = fetch(start_.data() + cells, stream_);
  require_device_memory(entries * sizeof(std::uint32_t), purpose);
  triangles_ = DeviceArray<std::uint32_t>(entries, stream_.get());
  grid_.triangles = triangles_.data();
  launch("fill_cells", fill_cells, over(triangles, kThreads), stream_, grid_, boxes_.data(),
         triangles);
}

void CrossingFinder::mark(const DeviceMeshView& mesh, const MoveStatesView& move_states,
                          int pass) const {
  launch("mark_crossed", mark_crossed, over(mesh.triangles, kThreads), stream_, grid_,
         boxes_.data(), mesh, move_states, pass);
}

}  // namespace vdwmesh
