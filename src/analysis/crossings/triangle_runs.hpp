// Runs of consecutive triangles of a mesh that are near each other, so that a search tree may sort
// them as one item.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/lanes/lanes.hpp"
#include "spheres/box.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// A box that grows by triangles; the last lane of its corners means nothing. Minima and maxima are
// taken of all axes together.
struct LaneBox {
  Lanes lower = all_lanes(std::numeric_limits<double>::infinity());
  Lanes upper = all_lanes(-std::numeric_limits<double>::infinity());

  VDWMESH_INLINE void include(const IndexedMesh& mesh, std::size_t triangle) {
    for (const std::uint32_t v : mesh.triangles[triangle]) {
      const Vec3d& at = mesh.positions[v];
      const Lanes p{at.x, at.y, at.z, at.z};
      lower = p < lower ? p : lower;
      upper = p > upper ? p : upper;
    }
  }
  VDWMESH_INLINE Box box() const {
    return {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
  }
};

// The box around the triangles [first, end) of the mesh. Precondition: their coordinates are
// finite.
inline Box box_of_triangles(const IndexedMesh& mesh, std::size_t first, std::size_t end) {
  LaneBox around;
  for (std::size_t t = first; t < end; ++t) around.include(mesh, t);
  return around.box();
}

// Returns the exponent of the width of a box, its longest side: width is in [2^e, 2^(e+1)). A point
// gets the least exponent, a width beyond all doubles the largest.
inline int width_exponent(const Box& box) {
  const Vec3d side = box.upper - box.lower;
  const double width = std::max({side.x, side.y, side.z});
  // Of normal numbers the exponent is read from their bits, which is quicker.
  constexpr int kBits = 52, kBias = 1023;
  const auto field = static_cast<int>(std::bit_cast<std::uint64_t>(width) >> kBits);
  if (field > 0 && field <= 2 * kBias) return field - kBias;
  return std::clamp(std::ilogb(width), -1074, 1024);
}

// The number of triangles of a run.
inline constexpr std::size_t kTriangleRun = 4;

// Returns how many consecutive triangles are to be sorted together: kTriangleRun if runs of so many
// are about as wide as four neighbours are, else 1. The children of a divided triangle are half as
// wide as all four together, which makes a difference of 1 between the mean exponents of the
// widths. A sample of the runs, spread evenly, decides. What a search finds does not depend on this
// choice, but the time that it takes does.
inline std::size_t triangles_together(const IndexedMesh& mesh) {
  constexpr std::size_t kSample = std::size_t{1} << 13;
  constexpr double kNear = 1.25;
  const std::size_t runs = mesh.triangle_count() / kTriangleRun;
  if (runs == 0) return 1;
  const std::size_t step = (runs + kSample - 1) / kSample;
  std::int64_t of_runs = 0, of_triangles = 0, sampled = 0;
  for (std::size_t run = 0; run < runs; run += step, ++sampled) {
    const std::size_t first = kTriangleRun * run, end = first + kTriangleRun;
    of_runs += width_exponent(box_of_triangles(mesh, first, end));
    for (std::size_t t = first; t < end; ++t) {
      of_triangles += width_exponent(box_of_triangles(mesh, t, t + 1));
    }
  }
  const auto count = static_cast<double>(sampled);
  const double wider = static_cast<double>(of_runs) / count -
                       static_cast<double>(of_triangles) / (count * kTriangleRun);
  return wider <= kNear ? kTriangleRun : 1;
}

}  // namespace vdwmesh
