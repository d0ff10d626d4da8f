// triangulate(): from spheres to the arrays of a regular triangulation.
//
// 1. Of concentric balls only the largest stays. Balls are numbered by place and scaled.
// 2. The cells are made in blocks of space, side by side (joined_cells.hpp).
// 3. Cells are sorted by their vertices, so that their order does not depend on the blocks.
#include "arrangement/complex/power_triangulation.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <tuple>

#include "arrangement/complex/joined_cells.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

// Returns the largest ball of each group of concentric balls, sorted by centre. Of equal balls the
// one with the lowest id stays. The sort puts this ball first in its group, because the radii are
// exchanged in the comparison: larger radii come first.
std::vector<SphereId> distinct_centers(const SphereSet& spheres) {
  std::vector<SphereId> ids(spheres.size());
  std::iota(ids.begin(), ids.end(), SphereId{0});
  tbb::parallel_sort(ids.begin(), ids.end(), [&](SphereId i, SphereId j) {
    const Sphere &a = spheres[i], &b = spheres[j];
    return std::tie(a.center.x, a.center.y, a.center.z, b.radius, i) <
           std::tie(b.center.x, b.center.y, b.center.z, a.radius, j);
  });
  const auto last = std::unique(ids.begin(), ids.end(), [&](SphereId i, SphereId j) {
    return spheres[i].center == spheres[j].center;
  });
  ids.erase(last, ids.end());
  return ids;
}

// The balls in the order of the frame. It numbers the balls, and with them the edges, triangles,
// arcs and corners of the boundary, and the vertices of crease-exact meshes.
std::vector<SphereId> spatial_order(const SphereSet& spheres, const SpatialFrame& frame) {
  struct Keyed {
    std::uint64_t key;
    SphereId id;
  };
  const std::vector<SphereId> ids = distinct_centers(spheres);
  Buffer<Keyed> keyed(ids.size());
  for_each_index(ids.size(), [&](std::size_t i) {
    keyed[i] = {frame.key(spheres[ids[i]].center), ids[i]};
  });
  tbb::parallel_sort(keyed.begin(), keyed.end(), [&](const Keyed& a, const Keyed& b) {
    return comes_before(a.key, spheres[a.id].center, b.key, spheres[b.id].center);
  });
  std::vector<SphereId> sorted(ids.size());
  for_each_index(ids.size(), [&](std::size_t i) { sorted[i] = keyed[i].id; });
  return sorted;
}

// The exponent for which 2^-exponent times the largest radius is in [1/2, 1).
int scale_exponent(const SphereSet& spheres) {
  double largest = 0;
  for (const Sphere& s : spheres.spheres()) largest = std::max(largest, s.radius);
  return std::ilogb(largest) + 1;
}

Sphere scaled(const Sphere& s, int exponent) {
  return {{std::ldexp(s.center.x, -exponent), std::ldexp(s.center.y, -exponent),
           std::ldexp(s.center.z, -exponent)},
          std::ldexp(s.radius, -exponent)};
}

// Returns the corners of a large tetrahedron around all balls: a corner below the bounding box and
// three points along the axes from there. With the box's size at most `reach`, every point of the
// box has coordinates of 4 to 5 reach from the corner. Their sum is at most 15 reach, and the far
// facet is where the sum is 32 reach. So every ball is far inside.
std::array<Vec3d, 4> auxiliary_points(const std::vector<Sphere>& balls) {
  Vec3d lower = balls[0].center, upper = lower;
  for (const Sphere& b : balls) {
    for (int k = 0; k < 3; ++k) {
      lower[k] = std::min(lower[k], b.center[k] - b.radius);
      upper[k] = std::max(upper[k], b.center[k] + b.radius);
    }
  }
  double reach = 0;
  for (int k = 0; k < 3; ++k) {
    // The reach is at least this fraction of the coordinates, so that adding it to them survives
    // rounding.
    constexpr double kLeastRelativeReach = 0x1p-40;
    reach = std::max({reach, upper[k] - lower[k], kLeastRelativeReach * std::abs(lower[k]),
                      kLeastRelativeReach * std::abs(upper[k])});
  }
  // Coordinates of up to 32 reach must be finite, with room for sums.
  if (!std::isfinite(64 * reach)) throw InvalidInput("the spheres' extent overflows a double");
  const Vec3d corner = lower - Vec3d{4 * reach, 4 * reach, 4 * reach};
  std::array<Vec3d, 4> points{corner, corner, corner, corner};
  for (int k = 0; k < 3; ++k) points[static_cast<std::size_t>(k) + 1][k] += 32 * reach;
  return points;
}

// Puts the cells in the order of their vertices, sorted by the lowest one first, so that cells near
// in space are near in memory, and the order is that of any other list of the same cells. A
// counting sort by the lowest vertex on all cores, which leaves the cells of one vertex in any
// order, then small sorts. `vertices` counts the auxiliary points too.
void store_sorted(const RegularCells& cells, std::size_t vertices, PowerTriangulation& out) {
  const std::size_t count = cells.cells.size();
  // While cells are placed, first[v + 1] is the next free place for vertex v. At the end it is the
  // first place for vertex v + 1.
  std::vector<std::uint32_t> first(vertices + 2, 0);
  for_each_index(count, [&](std::size_t c) {
    std::atomic_ref(first[cells.cells[c][0] + 2]).fetch_add(1, std::memory_order_relaxed);
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  struct Entry {
    CellVertices vertices;
    std::uint32_t place;  // in `cells`
  };
  Buffer<Entry> entries(count);
  for_each_index(count, [&](std::size_t c) {
    const CellVertices& cell = cells.cells[c];
    const auto place = std::atomic_ref(first[cell[0] + 1]).fetch_add(1, std::memory_order_relaxed);
    entries[place] = {cell, static_cast<std::uint32_t>(c)};
  });
  Buffer<std::uint32_t> number(count);  // by place
  out.cells.resize(count);
  out.neighbors.resize(count);
  for_each_index(vertices, [&](std::size_t v) {
    std::sort(entries.begin() + first[v], entries.begin() + first[v + 1],
              [](const Entry& a, const Entry& b) { return a.vertices < b.vertices; });
    for (std::uint32_t i = first[v]; i < first[v + 1]; ++i) number[entries[i].place] = i;
  });
  for_each_index(count, [&](std::size_t i) {
    out.cells[i] = entries[i].vertices;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t n = cells.neighbors[entries[i].place][k];
      out.neighbors[i][k] = n == kNoIndex ? n : number[n];
    }
  });
}

// As many blocks as there are cores, but not of fewer balls than are worth the margin around them.
std::size_t blocks_for_cores(std::size_t balls) {
  constexpr std::size_t kLeastBalls = 5000;
  const auto cores =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::max<std::size_t>(1, std::min(cores, balls / kLeastBalls));
}

}  // namespace

BallFrame ball_frame(const SphereSet& spheres) {
  if (spheres.empty()) throw InvalidInput("an empty set of spheres has no triangulation");
  return {spatial_frame(spheres), scale_exponent(spheres)};
}

PowerTriangulation triangulate(const SphereSet& spheres, Monitor* monitor,
                               std::optional<std::size_t> blocks) {
  return triangulate_part(spheres, ball_frame(spheres), monitor, blocks);
}

PowerTriangulation triangulate_part(const SphereSet& spheres, const BallFrame& frame,
                                    Monitor* monitor, std::optional<std::size_t> blocks) {
  PowerTriangulation out;
  if (spheres.empty()) throw InvalidInput("an empty set of spheres has no triangulation");
  out.ids = spatial_order(spheres, frame.order);
  out.scale_exponent = frame.scale_exponent;
  out.balls.reserve(out.ids.size());
  for (const SphereId id : out.ids) out.balls.push_back(scaled(spheres[id], out.scale_exponent));
  const std::array<Vec3d, 4> auxiliary = auxiliary_points(out.balls);
  const RegularCells cells = joined_cells(
      out.balls, auxiliary, blocks.value_or(blocks_for_cores(out.balls.size())), monitor);
  store_sorted(cells, out.balls.size() + auxiliary.size(), out);
  return out;
}

}  // namespace vdwmesh
