// Insertion of points into the triangulation. piece_insertion.hpp inserts pieces.
//
// A piece is an edge that must stay. An edge is Delaunay if the circle through the vertices of one
// of its triangles does not have the opposite vertex of the other triangle inside. A flip takes the
// edge between two triangles away and puts the other diagonal of their quadrilateral in its place.
// A tie is an in-circle test of four points that lie on one circle, or on one but for kTie.
//
// insert() leaves a triangulation in which every edge is Delaunay that was so before, but pieces
// and ties. It takes these steps:
//
// 1. locate() walks from a triangle near the point to the one that has it, across the edges beyond
//    which the point lies.
// 2. split() divides that triangle into three at the point. If the point lies on an edge, one of
//    the three is flat, and a flip of the edge removes it.
// 3. legalize_around_new() flips the edges opposite to the point while they are not Delaunay.
//
// Step 3 ends. An edge is flipped only if the fourth point lies strictly inside the circle, by an
// exact test. Lift every vertex to the height x² + y² above the plane: then each flip lowers the
// surface of the lifted triangles. So no triangulation comes back, and there are finitely many.
// Edges that stay because they are pieces or ties do not matter for this.
//
// The templates are for plane_triangulation.cpp, which compiles them for the host, and for the
// kernels of the device.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "creases/plane/plane_triangulation.hpp"

namespace vdwmesh {

// An in-circle test of patches is a tie up to this times its error bound, which is 12 · 2^-53 of
// the sum of its terms: up to 6e-9 of it. Atoms may lie 10^4 Å from the origin. There, coordinates
// on the unit sphere are off by 10^4 · 2^-53, and differences of neighbouring points, some 0.01 of
// the radius, by 1e-10 of their size, which the test multiplies by a few. An edge that stays though
// it is not Delaunay by so little costs no angle that could be seen. Of the tests that are no ties
// in truth, one in some 10^8 is taken for one, which does no harm either.
inline constexpr double kTie = 0x1p22;

// With e the largest absolute value of a coordinate, the frame has the corners (-3 e, -1.5 e), (3
// e, -1.5 e) and (0, 3 e). Its sides are at least 1.5 e from the origin, and the points at most
// sqrt(2) e.
template <class Memory>
VDWMESH_HD void PlaneTriangulationOf<Memory>::start(std::span<const PlanePoint> points,
                                                    const Circles* circles) {
  double e = 0;
  for (const PlanePoint& p : points) e = std::max(std::max(e, std::abs(p.x)), std::abs(p.y));
  if (!(e > 0)) e = 1;  // there is no point but the origin
  largest_ = 3 * e;
  points_.clear();
  points_.resize(kFrameCorners + points.size());
  if (memory_.has_failed()) return;
  points_[0] = {-largest_, -largest_ / 2};
  points_[1] = {largest_, -largest_ / 2};
  points_[2] = {0, largest_};
  for (std::size_t i = 0; i < points.size(); ++i) points_[kFrameCorners + i] = points[i];
  star_.assign(points_.size(), std::uint32_t{0});
  const std::uint32_t first = kFirstFrameCorner;
  triangles_.assign(1, LinkedTriangle{{first, first + 1, first + 2},
                                      {kNoNeighbor, kNoNeighbor, kNoNeighbor},
                                      {kNoPiece, kNoPiece, kNoPiece}});
  reset_scratch(circles);
}

template <class Memory>
void PlaneTriangulationOf<Memory>::save(State& state) const {
  state.largest = largest_;
  state.points = points_;
  state.triangles = triangles_;
  state.star = star_;
}

template <class Memory>
void PlaneTriangulationOf<Memory>::resume(const State& state, const Circles* circles) {
  largest_ = state.largest;
  points_ = state.points;
  triangles_ = state.triangles;
  star_ = state.star;
  reset_scratch(circles);
}

template <class Memory>
void PlaneTriangulationOf<Memory>::swap(State& state) {
  std::swap(largest_, state.largest);
  std::swap(points_, state.points);
  std::swap(triangles_, state.triangles);
  std::swap(star_, state.star);
}

// A point makes two triangles more. If there is no room, there will be room for half as many points
// again as there are, since the next round may add some more.
template <class Memory>
void PlaneTriangulationOf<Memory>::resume_swapped(std::size_t more_points, const Circles* circles) {
  if (points_.size() + more_points > points_.capacity()) {
    const std::size_t points = points_.size() + std::max(more_points, points_.size() / 2);
    points_.reserve(points);
    star_.reserve(points);
    triangles_.reserve(2 * points);
  }
  reset_scratch(circles);
}

template <class Memory>
VDWMESH_HD void PlaneTriangulationOf<Memory>::resume(double largest, const PlanePoint* plane_points,
                                                     const std::uint32_t* star, std::size_t points,
                                                     const LinkedTriangle* linked,
                                                     std::size_t triangles,
                                                     const Circles* circles) {
  largest_ = largest;
  points_.assign(plane_points, plane_points + points);
  star_.assign(star, star + points);
  triangles_.assign(linked, linked + triangles);
  reset_scratch(circles);
}

// Sets everything that is not part of the state.
template <class Memory>
VDWMESH_HD void PlaneTriangulationOf<Memory>::reset_scratch(const Circles* circles) {
  errors_ = PlaneErrors::up_to(largest_);
  circles_ = circles;
  inside_.assign(triangles_.size(), Side::outside);
  visits_.clear();
  search_ = 0;
  turn_ = 0;
  exact_tests_ = 0;
}

template <class Memory>
VDWMESH_HD std::uint32_t PlaneTriangulationOf<Memory>::add_point(const PlanePoint& p) {
  points_.push_back(p);
  star_.push_back(0);
  return static_cast<std::uint32_t>(points_.size()) - kFrameCorners - 1;
}

template <class Memory>
VDWMESH_HD int PlaneTriangulationOf<Memory>::orientation(const PlanePoint& a, const PlanePoint& b,
                                                         const PlanePoint& c) {
  if (const int sign = filtered_orientation(errors_, a, b, c)) return sign;
  ++exact_tests_;
  return memory_.undecided_orientation(a, b, c);
}

template <class Memory>
VDWMESH_HD int PlaneTriangulationOf<Memory>::orientation_of_point(std::uint32_t a, std::uint32_t b,
                                                                  const PlanePoint& p) {
  return orientation(point(a), point(b), p);
}

template <class Memory>
VDWMESH_HD int PlaneTriangulationOf<Memory>::orientation_of(std::uint32_t a, std::uint32_t b,
                                                            std::uint32_t c) {
  return orientation(point(a), point(b), point(c));
}

// Whether the vertices of a triangle and another vertex are points of one circle.
template <class Memory>
VDWMESH_HD bool PlaneTriangulationOf<Memory>::share_circle(const LinkedTriangle& t,
                                                           std::uint32_t vertex) const {
  const auto& v = t.vertices;
  return circles_ != nullptr && circles_->share(v[0], v[1], v[2], vertex);
}

// Whether p, which is vertex `vertex` or will be, lies inside the circumcircle of a triangle (1) or
// outside (-1). Ties give 0.
template <class Memory>
VDWMESH_HD int PlaneTriangulationOf<Memory>::in_circle(const LinkedTriangle& t, const PlanePoint& p,
                                                       std::uint32_t vertex) {
  const PlanePoint &a = point(t.vertices[0]), &b = point(t.vertices[1]), &c = point(t.vertices[2]);
  const CircleTerms terms(a, b, c, p);
  const double value = terms.determinant();
  if (const int sign = plane::sign_beyond(value, errors_.in_circle)) return sign;
  if (share_circle(t, vertex)) return 0;
  const double error = terms.error();
  if (circles_ != nullptr && std::abs(value) <= kTie * error) return 0;
  if (const int sign = plane::sign_beyond(value, error)) return sign;
  ++exact_tests_;
  return memory_.undecided_in_circle(a, b, c, p);
}

// Where p lies with respect to the edges of triangle t. The walk has come from triangle `from`, so
// p is on the inner side of the edge to it.
template <class Memory>
VDWMESH_HD typename PlaneTriangulationOf<Memory>::EdgeSides PlaneTriangulationOf<Memory>::sides(
    const PlanePoint& p, std::uint32_t t, std::uint32_t from) {
  const LinkedTriangle& w = triangles_[t];
  // A thread of a device tests all edges at once, as holds_for_any() tests all caps.
  int beyond_0 = 0, beyond_1 = 0, beyond_2 = 0;
  if constexpr (Memory::kIsBounded) {
    const PlanePoint &a = point(w.vertices[0]), &b = point(w.vertices[1]),
                     &c = point(w.vertices[2]);
    beyond_0 = filtered_orientation(errors_, b, c, p);
    beyond_1 = filtered_orientation(errors_, c, a, p);
    beyond_2 = filtered_orientation(errors_, a, b, p);
  }
  const auto side_of = [&](std::uint32_t k) {
    if constexpr (Memory::kIsBounded) {
      const int side = k == 0 ? beyond_0 : (k == 1 ? beyond_1 : beyond_2);
      return side != 0 ? side : memory_.undecided_orientation(p, p, p);
    } else {
      return orientation_of_point(w.vertices[corner_after(k)], w.vertices[corner_before(k)], p);
    }
  };
  // Always beginning with the same corner, walks could go in circles, since the triangulation is
  // not Delaunay across pieces.
  std::uint32_t k = turn_ = corner_after(turn_), on = 0;
  for (int i = 0; i < 3; ++i, k = corner_after(k)) {
    if (w.neighbors[k] == from && from != kNoNeighbor) continue;
    const int side = side_of(k);
    if (side < 0) return {k, 0};
    if (side == 0) on |= 1u << k;
  }
  return {kInside, on};
}

// The location of a point in triangle t that lies on the edges `on`, as bits. On two of them it
// lies on their common vertex, which is the third corner.
template <class Memory>
VDWMESH_HD PlaneTypes::Location PlaneTriangulationOf<Memory>::location(std::uint32_t t,
                                                                       std::uint32_t on) {
  if (on == 0) return {t, kInside, Place::inside};
  const bool one_edge = (on & (on - 1)) == 0;
  const std::uint32_t bit = one_edge ? on : 7 - on;
  return {t, bit / 2, one_edge ? Place::on_edge : Place::on_vertex};
}

template <class Memory>
VDWMESH_HD PlaneTypes::Location PlaneTriangulationOf<Memory>::locate(const PlanePoint& p,
                                                                     std::uint32_t near) {
  return locate_here(p, near);
}

template <class Memory>
VDWMESH_HD PlaneTypes::Location PlaneTriangulationOf<Memory>::locate_here(const PlanePoint& p,
                                                                          std::uint32_t near) {
  // The error bounds of the tests hold in the frame only. The test fails for NaN as well.
  if (!(std::abs(p.x) <= largest_ && std::abs(p.y) <= largest_)) return {near, 0, Place::outside};
  std::uint32_t t = near, from = kNoNeighbor;
  for (std::size_t steps = 0; steps <= 2 * triangles_.size(); ++steps) {
    const EdgeSides s = sides(p, t, from);
    if (memory_.has_failed()) return {t, 0, Place::outside};
    if (s.beyond == kInside) return location(t, s.on);
    from = t;
    t = triangles_[t].neighbors[s.beyond];
    if (t == kNoNeighbor) return {from, s.beyond, Place::outside};
  }
  return search_all(p);
}

// Looks at every triangle. Only a walk in circles leads here.
template <class Memory>
VDWMESH_HD PlaneTypes::Location PlaneTriangulationOf<Memory>::search_all(const PlanePoint& p) {
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const EdgeSides s = sides(p, t, kNoNeighbor);
    if (s.beyond == kInside) return location(t, s.on);
  }
  return {0, 0, Place::outside};
}

// Splits triangle t = (a, b, c) at a vertex inside of it, or on one of its edges; then one of the
// three new triangles is flat until the caller flips its edge. They are (vertex, b, c), which is t,
// (vertex, c, a) and (vertex, a, b). Puts the three on the stack.
template <class Memory>
VDWMESH_HD void PlaneTriangulationOf<Memory>::split(std::uint32_t t, std::uint32_t vertex) {
  LinkedTriangle& first = triangles_[t];
  const auto second = static_cast<std::uint32_t>(triangles_.size()), third = second + 1;
  // Number by number, as in flip().
  const std::uint32_t a = first.vertices[0], b = first.vertices[1], c = first.vertices[2];
  const std::uint32_t beyond_ca = first.neighbors[1], beyond_ab = first.neighbors[2];
  const std::uint32_t piece_ca = first.pieces[1], piece_ab = first.pieces[2];
  first.vertices[0] = vertex;
  first.neighbors[1] = second;
  first.neighbors[2] = third;
  first.pieces[1] = first.pieces[2] = kNoPiece;
  triangles_.push_back({{vertex, c, a}, {beyond_ca, third, t}, {piece_ca, kNoPiece, kNoPiece}});
  triangles_.push_back({{vertex, a, b}, {beyond_ab, t, second}, {piece_ab, kNoPiece, kNoPiece}});
  const auto side = inside_[t];
  inside_.push_back(side);
  inside_.push_back(side);
  relink(triangles_.data(), second, 0, t);
  relink(triangles_.data(), third, 0, t);
  star(b) = star(vertex) = t;
  star(c) = second;
  star(a) = third;
  stack_.push_back(t);
  stack_.push_back(second);
  stack_.push_back(third);
}

// flip() replaces one of the triangles at either end of the old edge, so the stars of these ends
// are set anew.
template <class Memory>
VDWMESH_HD void PlaneTriangulationOf<Memory>::flip_edge(std::uint32_t t, std::uint32_t corner) {
  const std::uint32_t n = triangles_[t].neighbors[corner];
  star(triangles_[t].vertices[corner_after(corner)]) = t;
  star(triangles_[t].vertices[corner_before(corner)]) = n;
  flip(triangles_.data(), t, corner);
}

// Whether an edge may be flipped and is not Delaunay. Then its two triangles form a convex
// quadrilateral: the fourth point lies in the circle, beyond the edge, so a straight line from the
// first to the fourth point crosses the edge between its ends.
template <class Memory>
VDWMESH_HD bool PlaneTriangulationOf<Memory>::should_flip(std::uint32_t t, std::uint32_t corner) {
  const LinkedTriangle& w = triangles_[t];
  if (w.neighbors[corner] == kNoNeighbor || w.pieces[corner] != kNoPiece) return false;
  const LinkedTriangle& n = triangles_[w.neighbors[corner]];
  const std::uint32_t apex = n.vertices[n.corner_opposite(t)];
  return in_circle(w, point(apex), apex) > 0;
}

// Flips edges opposite to a new vertex, which is corner 0 of the triangles on the stack. What
// should_flip() and flip_edge() do, with one look at each triangle.
template <class Memory>
VDWMESH_HD void PlaneTriangulationOf<Memory>::legalize_around_new() {
  LinkedTriangle* const all = triangles_.data();
  while (!stack_.empty()) {
    const std::uint32_t t = stack_.back();
    const LinkedTriangle& w = all[t];
    const std::uint32_t n = w.neighbors[0];
    if (n == kNoNeighbor || w.pieces[0] != kNoPiece) {
      stack_.pop_back();
      continue;
    }
    const std::uint32_t m = all[n].corner_opposite(t), apex = all[n].vertices[m];
    if (!(in_circle(w, point(apex), apex) > 0)) {
      stack_.pop_back();
      continue;
    }
    star(w.vertices[1]) = t;
    star(w.vertices[2]) = n;
    flip(all, t, 0, m);
    // Triangle t stays on the stack.
    stack_.push_back(n);
  }
}

template <class Memory>
VDWMESH_HD void PlaneTriangulationOf<Memory>::insert(std::uint32_t vertex, const Location& at) {
  insert_here(vertex, at);
}

template <class Memory>
VDWMESH_HD void PlaneTriangulationOf<Memory>::insert_here(std::uint32_t vertex,
                                                          const Location& at) {
  stack_.clear();
  split(at.triangle, vertex);
  if (at.place == Place::on_edge) {
    // The flat triangle at this edge. With the flip, both triangles at the edge are halved.
    const std::uint32_t flat = stack_[at.corner];
    stack_.push_back(triangles_[flat].neighbors[0]);
    flip_edge(flat, 0);
  }
  legalize_around_new();
}

template <class Memory>
VDWMESH_HD std::span<const PlaneTypes::TriangleEdge> PlaneTriangulationOf<Memory>::pieces_around(
    const PlanePoint& p, std::uint32_t at) {
  visits_.resize(triangles_.size(), 0);
  ++search_;
  found_.clear();
  stack_.assign(1, at);
  visits_[at] = search_;
  // The vertex that p would become. It has no labels.
  const auto vertex = static_cast<std::uint32_t>(points_.size()) - kFrameCorners;
  while (!stack_.empty()) {
    const std::uint32_t t = stack_.back();
    stack_.pop_back();
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t n = triangles_[t].neighbors[k];
      if (triangles_[t].pieces[k] != kNoPiece) {
        found_.push_back({t, k});
      } else if (n != kNoNeighbor && visits_[n] != search_ &&
                 in_circle(triangles_[n], p, vertex) > 0) {
        visits_[n] = search_;
        stack_.push_back(n);
      }
    }
  }
  return found_;
}

// From one triangle to the next, across edges that meet the disk.
template <class Memory>
std::span<const std::uint32_t> PlaneTriangulationOf<Memory>::triangles_at_disk(
    const PlanePoint& center, double radius, std::uint32_t from) {
  constexpr double kRounding = 1e-6, kRoundingOfFrame = 1e-12;
  const double reach = (1 + kRounding) * radius + kRoundingOfFrame * largest_;
  const auto meets = [&](const PlanePoint& a, const PlanePoint& b) {
    const double bx = b.x - a.x, by = b.y - a.y, cx = center.x - a.x, cy = center.y - a.y;
    const double t = std::clamp((cx * bx + cy * by) / (bx * bx + by * by), 0.0, 1.0);
    const double x = cx - t * bx, y = cy - t * by;
    return x * x + y * y <= reach * reach;
  };
  visits_.resize(triangles_.size(), 0);
  ++search_;
  stack_.assign(1, from);
  visits_[from] = search_;
  for (std::size_t i = 0; i < stack_.size(); ++i) {
    const LinkedTriangle& t = triangles_[stack_[i]];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t n = t.neighbors[k];
      if (n == kNoNeighbor || visits_[n] == search_) continue;
      if (!meets(point(t.vertices[corner_after(k)]), point(t.vertices[corner_before(k)]))) continue;
      visits_[n] = search_;
      stack_.push_back(n);
    }
  }
  return stack_;
}

}  // namespace vdwmesh
