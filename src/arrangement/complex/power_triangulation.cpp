// triangulate(): incremental insertion into CGAL's regular triangulation, flattened into arrays.
//
// 1. Of concentric balls only the largest stays. Balls are numbered in spatial order and scaled.
// 2. Four auxiliary points, then all balls in a biased randomized order, are inserted.
// 3. The finite cells (CGAL also keeps infinite ones, beyond the hull) are numbered and copied.
// The power test is our own predicate (power_predicates.hpp), which squares radii exactly. CGAL's
// own test takes weights, that is, squared radii that were rounded to double.
#include "arrangement/complex/power_triangulation.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_3.h>
#include <CGAL/Spatial_sort_traits_adapter_3.h>
#include <CGAL/Triangulation_ds_cell_base_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>
#include <ranges>
#include <tuple>

#include "arrangement/complex/power_predicates.hpp"
#include "core/errors.hpp"
#include "core/split_mix.hpp"

namespace vdwmesh {
namespace {

// The geometric traits of the triangulation. A weighted point carries the radius as its weight, and
// the power test squares it exactly.
struct PowerTraits : CGAL::Epick {
  struct Power_side_of_oriented_power_sphere_3 {
    using result_type = CGAL::Oriented_side;
    using P = Weighted_point_3;

    static Sphere sphere(const P& p) { return {{p.x(), p.y(), p.z()}, p.weight()}; }

    result_type operator()(const P& p, const P& q, const P& r, const P& s, const P& t) const {
      return static_cast<result_type>(
          power_side(sphere(p), sphere(q), sphere(r), sphere(s), sphere(t)));
    }
    // Tests among two to four points in a lower dimension. The auxiliary points come first and make
    // the triangulation three-dimensional, so these tests are never asked for.
    result_type operator()(const P&, const P&) const { return unreachable(); }
    result_type operator()(const P&, const P&, const P&) const { return unreachable(); }
    result_type operator()(const P&, const P&, const P&, const P&) const { return unreachable(); }

    static result_type unreachable() {
      assert(!"a degenerate power test cannot occur");
      return CGAL::ON_ORIENTED_BOUNDARY;
    }
  };
  Power_side_of_oriented_power_sphere_3 power_side_of_oriented_power_sphere_3_object() const {
    return {};
  }
};

}  // namespace
}  // namespace vdwmesh

// Lets CGAL locate points by a walk with inexact tests first, and exact tests from its end on, as
// it does for its own kernels.
template <>
struct CGAL::Triangulation_structural_filtering_traits<vdwmesh::PowerTraits> {
  using Use_structural_filtering_tag = Tag_true;
};

namespace vdwmesh {
namespace {

using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<
    std::uint32_t, PowerTraits, CGAL::Regular_triangulation_vertex_base_3<PowerTraits>>;
// A cell with a number. It is a model of CGAL's concept RegularTriangulationCellBase_3 that does
// not keep the list of points hidden in the cell, which makes the triangulation smaller.
template <class Base = CGAL::Triangulation_ds_cell_base_3<>>
struct NumberedCell : Base {
  template <class Tds>
  struct Rebind_TDS {
    using Other = NumberedCell<typename Base::template Rebind_TDS<Tds>::Other>;
  };
  using Base::Base;

  using Point = PowerTraits::Weighted_point_3;
  using Point_iterator = const Point*;
  using Point_const_iterator = const Point*;
  Point_iterator hidden_points_begin() const { return nullptr; }
  Point_iterator hidden_points_end() const { return nullptr; }
  void hide_point(const Point&) {}

  std::uint32_t& info() { return number_; }
  std::uint32_t info() const { return number_; }

 private:
  std::uint32_t number_ = kNoIndex;
};
using Triangulation =
    CGAL::Regular_triangulation_3<PowerTraits,
                                  CGAL::Triangulation_data_structure_3<VertexBase, NumberedCell<>>>;
using WeightedPoint = PowerTraits::Weighted_point_3;
using Point = PowerTraits::Point_3;

// Returns the largest ball of each group of concentric balls, sorted by centre. Of equal balls the
// one with the lowest id stays. The sort puts this ball first in its group, because the radii are
// exchanged in the comparison: larger radii come first.
std::vector<SphereId> distinct_centers(const SphereSet& spheres) {
  std::vector<SphereId> ids(spheres.size());
  std::iota(ids.begin(), ids.end(), SphereId{0});
  std::sort(ids.begin(), ids.end(), [&](SphereId i, SphereId j) {
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

// Orders the balls by CGAL's spatial_sort: several rounds along a Hilbert curve, with most balls in
// the last round. Within a round, balls that are near in space are near in memory. The order
// numbers the balls, and with them the vertices of crease-exact meshes. The balls are inserted in
// another order, that of insertion_order().
std::vector<SphereId> spatial_order(const SphereSet& spheres) {
  const std::vector<SphereId> ids = distinct_centers(spheres);
  std::vector<Point> points;
  points.reserve(ids.size());
  for (const SphereId id : ids) {
    const Vec3d& c = spheres[id].center;
    points.emplace_back(c.x, c.y, c.z);
  }
  std::vector<std::size_t> order(ids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  using Map = CGAL::Pointer_property_map<Point>::type;
  CGAL::spatial_sort(
      order.begin(), order.end(),
      CGAL::Spatial_sort_traits_adapter_3<CGAL::Epick, Map>(CGAL::make_property_map(points)));
  std::vector<SphereId> sorted(ids.size());
  std::transform(order.begin(), order.end(), sorted.begin(), [&](std::size_t i) { return ids[i]; });
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

// Returns the order of insertion, as indices of balls: a biased randomized insertion order (Amenta,
// Choi, Rote 2003). A hash of the index chooses the round: three zero bits at its end move a ball
// one round ahead. So the last round, rounds[0], has 7/8 of the balls, the one before it 7/8 of the
// rest, and so on. Each round is in spatial order.
std::vector<std::uint32_t> insertion_order(std::size_t count) {
  constexpr int kBitsPerRound = 3, kRounds = 6;
  std::array<std::vector<std::uint32_t>, kRounds> rounds;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t hash = split_mix((i + 1) * kSplitMixStep);
    const int round = std::min(std::countr_zero(hash) / kBitsPerRound, kRounds - 1);
    rounds[static_cast<std::size_t>(round)].push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<std::uint32_t> order;
  order.reserve(count);
  for (const auto& round : std::views::reverse(rounds)) {
    order.insert(order.end(), round.begin(), round.end());
  }
  return order;
}

// Inserts the auxiliary points, then the balls. Every search begins where the last one ended, which
// is near because the order is spatial. A ball that others hide is not inserted: insert() returns
// an empty handle. A ball that a later one hides loses its vertex.
void insert_all(Triangulation& triangulation, const std::vector<Sphere>& balls, Monitor* monitor) {
  Triangulation::Cell_handle hint;
  const auto insert = [&](const Vec3d& c, double radius, std::size_t index) {
    Triangulation::Locate_type type;
    int i, j;
    const WeightedPoint point(Point(c.x, c.y, c.z), radius);
    // Sets `type`, i and j, which say where in `cell` the point lies.
    const auto cell = triangulation.locate(point, type, i, j, hint);
    const auto vertex = triangulation.insert(point, type, cell, i, j);
    hint = cell;
    if (vertex == Triangulation::Vertex_handle()) return;
    vertex->info() = static_cast<std::uint32_t>(index);
    hint = vertex->cell();
  };
  const auto points = auxiliary_points(balls);
  for (std::size_t k = 0; k < points.size(); ++k) insert(points[k], 0, balls.size() + k);
  // The monitor is asked for cancellation once in so many balls.
  constexpr std::size_t kBallsPerCancellationCheck = 4096;
  std::size_t inserted = 0;
  for (const std::uint32_t i : insertion_order(balls.size())) {
    // Throws Cancelled on request; 0 steps are reported as done.
    if (++inserted % kBallsPerCancellationCheck == 0) advance(monitor, 0);
    insert(balls[i].center, balls[i].radius, i);
  }
}

// Numbers the finite cells in the order of their lowest vertex, with a counting sort, so that cells
// near in space are near in memory. Infinite cells get kNoIndex. `vertices` counts the auxiliary
// points too. Returns the number of finite cells.
std::size_t number_cells(const Triangulation& triangulation, std::size_t vertices) {
  const auto lowest = [](const auto& cell) {
    return std::min(std::min(cell->vertex(0)->info(), cell->vertex(1)->info()),
                    std::min(cell->vertex(2)->info(), cell->vertex(3)->info()));
  };
  const std::size_t count = triangulation.number_of_finite_cells();
  if (count >= kNoIndex) throw LimitExceeded("the triangulation has more than 2^32 cells");
  for (const auto cell : triangulation.all_cell_handles()) cell->info() = kNoIndex;
  // After the prefix sum, next[v] is the next free number for a cell with the lowest vertex v.
  std::vector<std::uint32_t> next(vertices + 1, 0);
  for (const auto cell : triangulation.finite_cell_handles()) ++next[lowest(cell) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (const auto cell : triangulation.finite_cell_handles()) cell->info() = next[lowest(cell)]++;
  return count;
}

// Copies the finite cells and their neighbours into the arrays of `out`.
void flatten(const Triangulation& triangulation, PowerTriangulation& out) {
  const std::size_t count = number_cells(triangulation, out.balls.size() + 4);
  out.cells.resize(count);
  out.neighbors.resize(count);
  for (const auto cell : triangulation.finite_cell_handles()) {
    for (int k = 0; k < 4; ++k) {
      const auto slot = static_cast<std::size_t>(k);
      out.cells[cell->info()][slot] = cell->vertex(k)->info();
      out.neighbors[cell->info()][slot] = cell->neighbor(k)->info();
    }
  }
}

}  // namespace

PowerTriangulation triangulate(const SphereSet& spheres, Monitor* monitor) {
  PowerTriangulation out;
  if (spheres.empty()) throw InvalidInput("an empty set of spheres has no triangulation");
  out.ids = spatial_order(spheres);
  out.scale_exponent = scale_exponent(spheres);
  out.balls.reserve(out.ids.size());
  for (const SphereId id : out.ids) out.balls.push_back(scaled(spheres[id], out.scale_exponent));

  Triangulation triangulation;
  insert_all(triangulation, out.balls, monitor);
  flatten(triangulation, out);
  return out;
}

}  // namespace vdwmesh
