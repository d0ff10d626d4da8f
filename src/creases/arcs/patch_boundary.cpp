// Gathers the boundary of one patch from the arcs around it, and the index needed for this.
//
// gather_pieces() numbers the corners of the patch first, in ascending order, then the other points
// arc by arc. split_pieces() adds points behind them in later rounds of meshing. point_sources()
// says which vertices of the mesh they all become.
#include "creases/arcs/patch_boundary.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "complex/placed_balls.hpp"
#include "complex/simplex_shape.hpp"
#include "core/fixed_blocks.hpp"
#include "creases/arcs/boundary_arcs.hpp"
#include "measures/exposed_boundary.hpp"

namespace vdwmesh {
namespace {

std::uint32_t index_of(std::uint32_t arc) { return arc; }
std::uint32_t index_of(const RimArc& rim) { return rim.arc; }

// The corners in which the arcs end, ascending, each once. `arcs` has indices of arcs, or RimArcs.
template <class Arcs>
void collect_corners(const BoundaryArcs& boundary, const Arcs& arcs,
                     std::vector<std::uint32_t>& corners) {
  corners.clear();
  for (const auto& a : arcs) {
    const BoundaryArc& arc = boundary.arcs[index_of(a)];
    if (arc.is_circle()) continue;
    for (const std::uint32_t end : arc.ends) corners.push_back(end);
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
}

// Numbers the points of a patch as gather_boundary() lists them: the corners in ascending order,
// then arc by arc the points between its ends.
class PointNumbers {
 public:
  template <class Arcs>
  PointNumbers(const BoundaryArcs& boundary, const ArcSampling& sampling, const Arcs& arcs)
      : boundary_(boundary), sampling_(sampling) {
    collect_corners(boundary, arcs, corners_);
    next_ = static_cast<std::uint32_t>(corners_.size());
  }

  const std::vector<std::uint32_t>& corners() const { return corners_; }

  // Goes on to the next of the arcs.
  void begin_arc(std::uint32_t arc) {
    arc_ = arc;
    first_ = next_;
    next_ += sampling_.pieces(arc) - (boundary_.arcs[arc].is_circle() ? 0 : 1);
  }
  // The number of sample point k of the arc that was begun last.
  std::uint32_t of(std::uint32_t k) const {
    const BoundaryArc& arc = boundary_.arcs[arc_];
    const std::uint32_t n = sampling_.pieces(arc_);
    if (arc.is_circle()) return first_ + (k == n ? 0 : k);
    if (k == 0 || k == n) return place_of(arc.ends[k == 0 ? 0 : 1]);
    return first_ + k - 1;
  }

 private:
  std::uint32_t place_of(std::uint32_t corner) const {
    return static_cast<std::uint32_t>(std::lower_bound(corners_.begin(), corners_.end(), corner) -
                                      corners_.begin());
  }

  const BoundaryArcs& boundary_;
  const ArcSampling& sampling_;
  std::vector<std::uint32_t> corners_;
  std::uint32_t arc_ = 0, first_ = 0, next_ = 0;
};

// The unit vector from a sphere's centre to a point of the sphere.
Vec3d direction(const Sphere& s, const Vec3d& p) { return (1 / s.radius) * (p - s.center); }

}  // namespace

PatchIndex::PatchIndex(const PlacedBalls& balls, const ExposedBoundary& exposed,
                       const BoundaryArcs& boundary)
    : exposed_(exposed) {
  arcs_.fill(balls.balls.size(), boundary.arcs.size(), [&](std::size_t a, const auto& add) {
    for (const std::uint32_t ball : boundary.arcs[a].balls) {
      add(ball, static_cast<std::uint32_t>(a));
    }
  });
  if (!boundary.has_joined_corners) return;
  const auto each_ball_of_corner = [&](const auto& visit) {
    for (const BoundaryArc& arc : boundary.arcs) {
      if (arc.is_circle()) continue;
      for (const std::uint32_t end : arc.ends) {
        for (const std::uint32_t ball : arc.balls) visit(end, ball);
      }
    }
  };
  balls_.fill(boundary.corners.size(), each_ball_of_corner);
}

std::span<const std::uint32_t> PatchIndex::arcs(std::uint32_t ball) const { return arcs_[ball]; }

std::span<const std::uint32_t> PatchIndex::neighbors(std::uint32_t ball) const {
  return exposed_.neighbors(ball);
}

std::span<const std::uint32_t> PatchIndex::balls_at(std::uint32_t corner) const {
  if (balls_.size() == 0) return {};
  return balls_[corner];
}

CoveredCap covered_cap(const BoundaryArcs& boundary, const Sphere& s, const Sphere& neighbor) {
  const EdgeShape shape = edge_shape(s, neighbor);
  const double cosine = shape.height[0] / s.radius;
  // boundary_arcs() has made a contact vanish, so there are no arcs around its cap. If the cap is
  // smaller than a hemisphere, the squared distance 0 makes it cover nothing. It also keeps
  // buried_pole() from choosing this cap, whose centre lies in the patch.
  const bool contact = boundary.is_contact(std::sqrt(shape.squared_circle_radius),
                                           std::min(s.radius, neighbor.radius));
  const double squared_sine = contact ? 0 : shape.squared_circle_radius / (s.radius * s.radius);
  // For the angular radius a, the squared distance from the rim to the axis is 2 - 2 |cos a|. This
  // cancels for a tiny cap, so it is computed as 2 sin² a / (1 + |cos a|).
  return {(1 / shape.length) * (neighbor.center - s.center), cosine,
          2 * squared_sine / (1 + std::abs(cosine))};
}

void gather_pieces(const BoundaryArcs& boundary, const ArcSampling& sampling, const Sphere& s,
                   std::uint32_t side, std::span<const RimArc> arcs, PatchBoundary& out) {
  PointNumbers numbers(boundary, sampling, arcs);
  std::size_t count = 0;
  for (const RimArc& a : arcs) count += sampling.pieces(a.arc);
  out.points.clear();
  out.pieces.clear();
  out.pieces.reserve(with_room_for_splits(count));
  out.points.reserve(with_room_for_splits(count + numbers.corners().size()));
  for (const std::uint32_t c : numbers.corners()) {
    out.points.push_back(direction(s, boundary.corners[c].position));
  }
  for (const auto& [a, circle, cosine] : arcs) {
    const BoundaryArc& arc = boundary.arcs[a];
    // The patch of the second ball lies on the left of the arc. For the first ball the pieces run
    // backwards.
    const bool is_first = arc.balls[0] == side;
    const std::uint32_t n = sampling.pieces(a);
    numbers.begin_arc(a);
    for (std::uint32_t k = arc.is_circle() ? 0 : 1; k < n; ++k) {
      out.points.push_back(direction(s, sampling.point(a, k)));
    }
    // The bulge of a piece. A circle of angular radius a has the geodesic curvature cot a and the
    // radius sin a on the unit sphere. So along a piece of angle x it turns by x cos a against a
    // great circle, and half of this falls to each end. For a cap smaller than a hemisphere, cos a
    // is positive and the arc bulges away from the cap, into the patch.
    const double half_turn = cosine / 2;
    std::uint32_t from = numbers.of(0);
    double begin = 0;  // of the piece, as a fraction of the arc
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t to = numbers.of(k + 1);
      const double end = sampling.part(a, k + 1);
      out.pieces.push_back({is_first ? to : from,
                            is_first ? from : to,
                            circle,
                            {a, k},
                            half_turn * (arc.sweep * (end - begin))});
      from = to;
      begin = end;
    }
  }
}

void gather_boundary(const PlacedBalls& balls, const BoundaryArcs& boundary,
                     const ArcSampling& sampling, const PatchIndex& index, std::uint32_t ball,
                     PatchBoundary& out) {
  const Sphere& s = balls.balls[ball];
  const auto cap_of = [&](std::uint32_t neighbor) {
    return covered_cap(boundary, s, balls.balls[neighbor]);
  };
  out = {};
  const std::span<const std::uint32_t> neighbors = index.neighbors(ball);
  out.caps.reserve(neighbors.size());
  for (const std::uint32_t n : neighbors) out.caps.push_back(cap_of(n));
  // Only arcs between patches whose middle one had no width lie on a cap that is not listed.
  const auto cosine_of = [&](std::uint32_t neighbor) {
    const auto at = std::ranges::lower_bound(neighbors, neighbor);
    return at == neighbors.end() || *at != neighbor
               ? cap_of(neighbor).cosine
               : out.caps[static_cast<std::size_t>(at - neighbors.begin())].cosine;
  };
  std::vector<RimArc> rims;
  rims.reserve(index.arcs(ball).size());
  for (const std::uint32_t a : index.arcs(ball)) {
    const auto& of_arc = boundary.arcs[a].balls;
    const std::uint32_t neighbor = of_arc[of_arc[0] == ball ? 1 : 0];
    rims.push_back({a, neighbor, cosine_of(neighbor)});
  }
  gather_pieces(boundary, sampling, s, ball, rims, out);
  // The spheres through corners that were joined.
  if (boundary.has_joined_corners) {
    std::vector<std::uint32_t> corners;
    collect_corners(boundary, rims, corners);
    for (std::uint32_t point = 0; point < corners.size(); ++point) {
      for (const std::uint32_t other : index.balls_at(corners[point])) {
        if (other != ball) out.through.push_back({point, other});
      }
    }
  }
}

std::vector<std::uint32_t> boundary_order(std::size_t points) {
  const auto count = static_cast<std::uint32_t>(points);
  std::vector<std::uint32_t> order;
  order.reserve(count);
  // The first loop takes every step-th point: all points if there are few, otherwise the first and
  // usually one more, since the largest power of two up to `count` is more than half of it. Each
  // round of the second loop takes the points halfway between those taken so far, until the step is
  // 1 and all points have been taken.
  std::uint32_t step = count < kReorderedPoints ? 1 : std::bit_floor(count);
  for (std::uint32_t i = 0; i < count; i += step) order.push_back(i);
  for (; step > 1; step /= 2) {
    for (std::uint32_t i = step / 2; i < count; i += step) order.push_back(i);
  }
  return order;
}

namespace {

// Splits one piece of a boundary, as ArcSampling has split it. `backwards` says that the arc runs
// from the end of the piece to its beginning.
SplitChain split_piece(const Sphere& s, const ArcSampling& sampling, bool backwards,
                       const PieceSplit& split, std::uint32_t p, PatchBoundary& out) {
  const std::uint32_t parts = split.parts();
  const BoundaryPiece whole = out.pieces[p];
  const SplitChain chain{p, parts, static_cast<std::uint32_t>(out.pieces.size()),
                         static_cast<std::uint32_t>(out.points.size())};
  const auto [arc, first] = whole.source;
  for (std::uint32_t j = 1; j < parts; ++j) {
    const std::uint32_t k = first + (backwards ? parts - j : j);
    out.points.push_back(direction(s, sampling.point(arc, k)));
  }
  for (std::uint32_t j = 0; j < parts; ++j) {
    const std::uint32_t along = backwards ? parts - 1 - j : j;  // the number of the part on its arc
    const BoundaryPiece part{
        j == 0 ? whole.from : chain.first_point + j - 1,
        j + 1 == parts ? whole.to : chain.first_point + j,
        whole.neighbor,
        {arc, first + along},
        whole.bulge * (split.fraction_of_first(along + 1) - split.fraction_of_first(along))};
    if (j == 0) {
      out.pieces[p] = part;
    } else {
      out.pieces.push_back(part);
    }
  }
  return chain;
}

}  // namespace

void split_pieces(const BoundaryArcs& boundary, const ArcSampling& sampling, const Sphere& s,
                  std::uint32_t side, std::span<const PieceSplit> splits, PatchBoundary& out,
                  PatchVector<SplitChain>& chains) {
  if (splits.empty()) return;
  const auto count = static_cast<std::uint32_t>(out.pieces.size());
  // The first split of an arc. Pieces of one arc follow each other as a rule.
  std::uint32_t arc = kNoIndex;
  auto first = splits.end();
  for (std::uint32_t p = 0; p < count; ++p) {
    const ArcPiece source = out.pieces[p].source;
    if (source.arc != arc) {
      arc = source.arc;
      first = splits.begin() + static_cast<std::ptrdiff_t>(sampling.first_split(arc, splits));
    }
    auto split = first;
    // Splits before the piece on its arc have moved its number.
    for (; split != splits.end() && split->piece < source; ++split) {
      out.pieces[p].source.piece += split->parts() - 1;
    }
    if (split == splits.end() || split->piece != source) continue;
    const bool backwards = boundary.arcs[source.arc].balls[0] == side;
    chains.push_back(split_piece(s, sampling, backwards, *split, p, out));
  }
}

// Every point is an end of a piece.
void point_sources(const BoundaryArcs& boundary, const ArcSampling& sampling, std::uint32_t side,
                   const PatchBoundary& points, std::span<PointSource> out) {
  for (const BoundaryPiece& piece : points.pieces) {
    const auto [arc, k] = piece.source;
    const bool backwards = boundary.arcs[arc].balls[0] == side;
    out[piece.from] = sampling.source(arc, backwards ? k + 1 : k);
    out[piece.to] = sampling.source(arc, backwards ? k : k + 1);
  }
}

void boundary_vertices(const BoundaryArcs& boundary, const ArcSampling& sampling,
                       const PatchIndex& index, std::uint32_t ball,
                       std::vector<std::uint32_t>& out) {
  collect_corners(boundary, index.arcs(ball), out);
  for (const std::uint32_t a : index.arcs(ball)) {
    for (std::uint32_t k = boundary.arcs[a].is_circle() ? 0 : 1; k < sampling.pieces(a); ++k) {
      out.push_back(sampling.vertex(a, k));
    }
  }
}

}  // namespace vdwmesh
