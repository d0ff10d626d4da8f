// arrange(): rows of corners and arcs by ball, then one list of each.
//
// 1. cell_boundary() makes the rows of all balls that double precision decides.
// 2. The others, and all balls that touch one of them or nearly do, get their rows from a
//    triangulation: of these balls and of all that touch them. Which of its simplices at a ball are
//    in the dual complex depends on nothing else, because a simplex is in it if its balls have a
//    common point that no other ball covers more deeply, and a ball that does so touches them all.
//    So every corner and arc that a doubtful ball takes part in comes from the triangulation: the
//    ball in whose row it stands touches that ball.
// 3. Corners and arcs are sorted row by row, and arcs get the numbers of their corners. Each corner
//    must end three arcs. Should the rows of two balls contradict each other, all is triangulated.
#include "creases/arcs/arrangement.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iterator>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "core/fixed_blocks.hpp"
#include "measures/arcs/boundary_rows.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {
namespace {

// Into how many blocks a triangulation is divided: as many as there are cores, of some hundred
// balls at least. Small blocks cost more work in all than one for a small set, but less time.
std::size_t blocks_of(std::size_t balls) {
  constexpr std::size_t kLeastBalls = 500;
  const auto cores =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::clamp<std::size_t>(balls / kLeastBalls, 1, cores);
}

// Two balls touch, or nearly do, if their distance is at most this times the sum of their radii.
// It is beyond what raises a doubt (arcs::kTouching).
constexpr double kTouchingReach = 1 + 1e-6;

// Calls visit(ball) for all balls that touch the one at a list place, itself included. However far
// the balls are from the origin, none is missed. The difference of two centres has an error of half
// a unit in its own last place, not in that of the coordinates. The corners of the box err by half
// a unit in the last place of a coordinate of this ball, which is at most that of the other ball
// plus both radii. A share of 1e-6 of this ball's radius is there to spare, and the reach of the
// other ball's level is larger than its radius by 32 units in the last place of the largest
// coordinate or reach of the level.
template <class Visit>
void visit_touching(const CellListView& list, ListPlace place, const Visit& visit) {
  const Sphere& s = list.spheres[place];
  const double reach = kTouchingReach * s.radius;
  const Vec3d around{reach, reach, reach};
  visit_near_box(list, s.center - around, s.center + around, [&](ListPlace other) {
    const Sphere& o = list.spheres[other];
    if (norm(o.center - s.center) <= kTouchingReach * (s.radius + o.radius)) visit(list.id[other]);
    return false;
  });
}

// Adds to a set of balls, given by a flag for each, all that touch one of them.
std::vector<std::uint8_t> with_touching(const CellListView& list,
                                        const std::vector<std::uint8_t>& balls) {
  std::vector<std::uint8_t> out(balls.size(), 0);
  for_each_index(balls.size(), [&](std::size_t i) {
    const auto place = static_cast<ListPlace>(i);
    if (!balls[list.id[place]]) return;
    visit_touching(list, place, [&](std::uint32_t ball) {
      std::atomic_ref(out[ball]).store(1, std::memory_order_relaxed);
    });
  });
  return out;
}

std::vector<std::uint32_t> members(const std::vector<std::uint8_t>& balls) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t b = 0; b < balls.size(); ++b) {
    if (balls[b]) out.push_back(b);
  }
  return out;
}

// Rows that a triangulation decides, and the areas of their balls.
struct ExactRows {
  std::vector<std::uint32_t> row_of;  // by ball; kNoIndex: it has none here
  BoundaryRows rows;
  std::vector<double> areas;  // by row
};

// Rows of the balls `wanted`, ascending, by a triangulation of the balls `all`, which has what
// touches them.
ExactRows exact_rows(const std::vector<Sphere>& balls, const std::vector<std::uint32_t>& wanted,
                     const std::vector<std::uint32_t>& all, Monitor* monitor,
                     std::uint64_t memory_limit) {
  std::vector<Sphere> spheres;
  for (const std::uint32_t b : all) spheres.push_back(balls[b]);
  const PowerTriangulation t =
      triangulate(SphereSet(std::move(spheres)), monitor, blocks_of(all.size()), memory_limit);
  const ExposedBoundary local = exposed_boundary(t, dual_complex(t, monitor));
  const auto number = [&](std::uint32_t i) { return all[t.ids[i]]; };
  const auto corner = [&](std::uint32_t c) {
    const ExposedCorner& of = local.corners[c];
    return exposed_corner({number(of.balls[0]), number(of.balls[1]), number(of.balls[2])}, of.side);
  };
  ExactRows out{
      std::vector<std::uint32_t>(balls.size(), kNoIndex), {}, std::vector<double>(wanted.size())};
  for (std::uint32_t row = 0; row < wanted.size(); ++row) out.row_of[wanted[row]] = row;
  struct Owned {
    std::uint32_t row, index;
    bool operator<(const Owned& o) const { return row < o.row; }
  };
  // Corners and arcs go to the row of their lowest ball, in the numbers of all balls.
  std::vector<Owned> corners, arcs;
  std::vector<ExposedCorner> named;
  for (std::uint32_t c = 0; c < local.corners.size(); ++c) {
    named.push_back(corner(c));
    const std::uint32_t row = out.row_of[named[c].balls[0]];
    if (row != kNoIndex) corners.push_back({row, c});
  }
  for (std::uint32_t a = 0; a < local.arcs.size(); ++a) {
    const auto& [first, second] = local.arcs[a].balls;
    const std::uint32_t row = out.row_of[std::min(number(first), number(second))];
    if (row != kNoIndex) arcs.push_back({row, a});
  }
  std::ranges::stable_sort(corners, std::less<>{});
  std::ranges::stable_sort(arcs, std::less<>{});
  std::vector<std::uint32_t> local_of(wanted.size());
  for (std::uint32_t i = 0; i < t.ids.size(); ++i) {
    const std::uint32_t row = out.row_of[number(i)];
    if (row != kNoIndex) local_of[row] = i;
  }
  auto next_corner = corners.begin();
  auto next_arc = arcs.begin();
  for (std::uint32_t row = 0; row < wanted.size(); ++row) {
    for (; next_corner != corners.end() && next_corner->row == row; ++next_corner) {
      out.rows.corners.push_back(named[next_corner->index]);
    }
    for (; next_arc != arcs.end() && next_arc->row == row; ++next_arc) {
      const CornerArc& arc = local.arcs[next_arc->index];
      NamedArc of{{number(arc.balls[0]), number(arc.balls[1])}, arc.is_circle(), {}, {}};
      if (!arc.is_circle()) {
        of.start = named[arc.corners[0]];
        of.end = named[arc.corners[1]];
      }
      // The arc runs about the axis from its first ball to its second; about the opposite axis it
      // runs backwards.
      if (of.balls[0] > of.balls[1]) {
        std::swap(of.balls[0], of.balls[1]);
        std::swap(of.start, of.end);
      }
      out.rows.arcs.push_back(of);
    }
    for (const std::uint32_t n : local.neighbors(local_of[row])) {
      out.rows.neighbors.push_back(number(n));
    }
    out.rows.end_row();
    // The triangulation has scaled its balls once more.
    out.areas[row] = std::ldexp(local.areas[local_of[row]], 2 * t.scale_exponent);
  }
  return out;
}

// Puts the rows of all balls behind each other.
class RowJoiner {
 public:
  RowJoiner(const CellBoundary& cells, const ExactRows& exact)
      : cells_(cells), exact_(exact), count_(cells.is_doubtful.size()) {}

  // Returns whether the rows fit together.
  bool run(ExposedBoundary& out) const {
    std::vector<std::size_t> first_corner(count_ + 1, 0), first_arc(count_ + 1, 0);
    out.first_neighbor.assign(count_ + 1, 0);
    for_each_index(count_, [&](std::size_t b) {
      const RowOfBall row = row_of(b);
      first_corner[b + 1] = row.corners.size();
      first_arc[b + 1] = row.arcs.size();
      out.first_neighbor[b + 1] = row.neighbors.size();
    });
    for (auto* first : {&first_corner, &first_arc, &out.first_neighbor}) {
      std::partial_sum(first->begin(), first->end(), first->begin());
    }
    if (std::max(first_corner.back(), first_arc.back()) >= kNoIndex) return false;
    out.corners.resize(first_corner.back());
    out.arcs.resize(first_arc.back());
    out.neighbor_lists.resize(out.first_neighbor.back());
    for_each_index(count_, [&](std::size_t b) {
      const RowOfBall row = row_of(b);
      const auto corners = out.corners.begin() + static_cast<std::ptrdiff_t>(first_corner[b]);
      std::sort(corners, std::ranges::copy(row.corners, corners).out);
      const auto neighbors =
          out.neighbor_lists.begin() + static_cast<std::ptrdiff_t>(out.first_neighbor[b]);
      std::sort(neighbors, std::ranges::copy(row.neighbors, neighbors).out);
    });
    return name_corners(first_corner, first_arc, out);
  }

 private:
  struct RowOfBall {
    std::span<const ExposedCorner> corners;
    std::span<const NamedArc> arcs;
    std::span<const std::uint32_t> neighbors;
  };

  RowOfBall row_of(std::size_t ball) const {
    const std::uint32_t exact = exact_.row_of.empty() ? kNoIndex : exact_.row_of[ball];
    const BoundaryRows& rows = exact != kNoIndex ? exact_.rows : cells_.rows[ball / kBallsPerRows];
    const std::size_t row = exact != kNoIndex ? exact : ball % kBallsPerRows;
    return {rows.corners_of(row), rows.arcs_of(row), rows.neighbors_of(row)};
  }

  // Looks up the numbers of the arcs' corners, sorts the arcs of each ball, and counts the arcs
  // that end in each corner.
  bool name_corners(const std::vector<std::size_t>& first_corner,
                    const std::vector<std::size_t>& first_arc, ExposedBoundary& out) const {
    std::vector<std::uint8_t> ends(out.corners.size(), 0);
    std::atomic<bool> fits{true};
    const auto number_of = [&](const ExposedCorner& corner) {
      const auto begin = out.corners.begin() +
                         static_cast<std::ptrdiff_t>(first_corner[corner.balls[0]]),
                 end = out.corners.begin() +
                       static_cast<std::ptrdiff_t>(first_corner[corner.balls[0] + 1]);
      const auto found = std::lower_bound(begin, end, corner);
      if (found == end || *found != corner) {
        fits = false;
        return kNoIndex;
      }
      const auto number = static_cast<std::uint32_t>(found - out.corners.begin());
      std::atomic_ref(ends[number]).fetch_add(1, std::memory_order_relaxed);
      return number;
    };
    for_each_index(count_, [&](std::size_t b) {
      const std::span<const NamedArc> arcs = row_of(b).arcs;
      const auto begin = out.arcs.begin() + static_cast<std::ptrdiff_t>(first_arc[b]);
      for (std::size_t i = 0; i < arcs.size(); ++i) {
        CornerArc& arc = begin[static_cast<std::ptrdiff_t>(i)];
        arc = {arcs[i].balls, {kNoIndex, kNoIndex}};
        if (!arcs[i].is_circle) arc.corners = {number_of(arcs[i].start), number_of(arcs[i].end)};
      }
      std::sort(begin, begin + static_cast<std::ptrdiff_t>(arcs.size()));
    });
    const auto odd =
        collect<std::uint32_t>(ends.size(), [&](std::size_t c, std::vector<std::uint32_t>& found) {
          if (ends[c] != 3) found.push_back(static_cast<std::uint32_t>(c));
        });
    return fits && odd.empty();
  }

  const CellBoundary& cells_;
  const ExactRows& exact_;
  std::size_t count_;
};

// Whether a scaled ball is of an ordinary size, so that the cells, and the triangulation of any
// part of the balls, have numbers that neither over- nor underflow.
bool is_ordinary(const Sphere& s) {
  constexpr double kLeastRadius = 1e-30;  // of the largest
  const Vec3d& c = s.center;
  return s.radius >= kLeastRadius &&
         std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)}) <= kFarthestSphere;
}

// Decides all by the triangulation of all balls.
void arrange_by_triangulation(Arrangement& a, Monitor* monitor, std::uint64_t memory_limit) {
  a.whole = whole_complex(a.balls, monitor, memory_limit);
  a.boundary = exposed_boundary(a.whole->triangulation, a.whole->complex);
}

}  // namespace

WholeComplex whole_complex(const PlacedBalls& balls, Monitor* monitor, std::uint64_t memory_limit) {
  WholeComplex out{
      triangulate(PlacedBalls(balls), monitor, blocks_of(balls.balls.size()), memory_limit), {}};
  out.complex = dual_complex(out.triangulation, monitor);
  return out;
}

Arrangement arrange(const SphereSet& spheres, Monitor* monitor, std::uint64_t memory_limit) {
  return arrange(placed_balls(spheres), monitor, memory_limit);
}

Arrangement arrange(PlacedBalls placed, Monitor* monitor, std::uint64_t memory_limit) {
  Arrangement a;
  a.balls = std::move(placed);
  const std::vector<Sphere>& balls = a.balls.balls;
  a.is_ordinary = std::ranges::all_of(balls, is_ordinary);
  if (!a.is_ordinary) {
    a.is_doubtful.assign(balls.size(), 1);
    arrange_by_triangulation(a, monitor, memory_limit);
    return a;
  }
  const CellList list = make_ball_list(SphereSet::view(balls));
  CellBoundary cells = cell_boundary(list.view(), monitor);
  a.is_doubtful = cells.is_doubtful;
  ExactRows exact;
  const auto doubtful =
      static_cast<std::size_t>(std::ranges::count(cells.is_doubtful, std::uint8_t{1}));
  if (2 * doubtful > balls.size()) {
    arrange_by_triangulation(a, monitor, memory_limit);
    return a;
  }
  if (doubtful > 0) {
    const std::vector<std::uint8_t> wanted = with_touching(list.view(), cells.is_doubtful);
    const std::vector<std::uint32_t> rows = members(wanted),
                                     all = members(with_touching(list.view(), wanted));
    if (2 * all.size() > balls.size()) {
      arrange_by_triangulation(a, monitor, memory_limit);
      return a;
    }
    exact = exact_rows(balls, rows, all, monitor, memory_limit);
    for (std::size_t i = 0; i < rows.size(); ++i) cells.areas[rows[i]] = exact.areas[i];
  }
  if (RowJoiner(cells, exact).run(a.boundary)) {
    a.boundary.areas = std::move(cells.areas);
  } else {
    arrange_by_triangulation(a, monitor, memory_limit);
  }
  return a;
}

}  // namespace vdwmesh
