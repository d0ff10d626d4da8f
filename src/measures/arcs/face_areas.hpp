// The areas of the faces that the power cell of a ball has inside the ball: each is the contact
// with one neighbour, the part of the plane between the two balls that no other ball takes.
//
// A face is bounded by segments of the cell's edges and by arcs of the circle in which its plane
// cuts the sphere. By Green's theorem about the circle's centre twice its area is
//   2 F = sum det(axis, p, q) over its segments from p to q + phi sine²,
// counter-clockwise about the axis, with phi the exposed angle of the circle.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "measures/arcs/ball_measures.hpp"

namespace vdwmesh::arcs {

// The ends of an edge's part inside the ball, if there is one. What decides in
// BallMeasurer::add_edge() whether an edge crosses the sphere decides here too.
inline std::optional<std::array<Vec3d, 2>> segment_inside(const CellView& cell, EdgeEnd end) {
  const auto [from_vertex, to_vertex, plane_a, plane_b] = BallMeasurer::edge_of(cell, end);
  Vec3d from = cell.vertex(from_vertex), to = cell.vertex(to_vertex);
  const bool starts_inside = inner(from, from) - 1 < 0, ends_inside = inner(to, to) - 1 < 0;
  if (starts_inside && ends_inside) return {{from, to}};
  const bool is_outer = !starts_inside && !ends_inside;
  const Vec3d along = to - from;
  if (is_outer && !(inner(from, along) < 0 && inner(to, along) > 0)) return std::nullopt;
  const Cap& a = cell.plane[plane_a];
  const Cap& b = cell.plane[plane_b];
  const bool a_is_smaller = std::abs(a.cosine) >= std::abs(b.cosine);
  const Cap& small = a_is_smaller ? a : b;
  const Crossing c = crossing_of(small, a_is_smaller ? b : a);
  if (is_outer && !(c.gram > 0)) return std::nullopt;
  const double root = std::sqrt(c.gram > 0 ? c.gram : 0), inverse = 1 / c.squared_sine;
  const Vec3d middle =
      small.cosine * small.axis + (c.toward * inverse) * cross(c.normal, small.axis);
  const Vec3d half = (a_is_smaller ? root * inverse : -root * inverse) * c.normal;
  if (!starts_inside) from = middle + half;
  if (!ends_inside) to = middle - half;
  return {{from, to}};
}

// Fills areas[plane] for the planes of the cell, in units of the ball's squared radius.
// Precondition: `measurer` has just measured this cell. Doubts are the measurer's.
inline void face_areas(const CellView& cell, const BallMeasurer& measurer,
                       std::vector<double>& areas) {
  areas.assign(cell.plane_count, 0);
  for (std::uint32_t v = 0; v < cell.vertex_count; ++v) {
    for (std::uint32_t side = 1; side <= 3; ++side) {
      const EdgeEnd end = end_of(v, side);
      if (end > cell.twin[end]) continue;  // each edge once
      const auto segment = segment_inside(cell, end);
      if (!segment) continue;
      const auto [from, to, a, b] = BallMeasurer::edge_of(cell, end);
      const Vec3d moment = cross((*segment)[0], (*segment)[1]);
      areas[a] -= 0.5 * inner(cell.plane[a].axis, moment);
      areas[b] += 0.5 * inner(cell.plane[b].axis, moment);
    }
  }
  if (!measurer.has_faces()) return;  // without an exposed patch there are no arcs
  for (const std::uint32_t plane : measurer.planes()) {
    const BallMeasurer::CellFace& face = measurer.face(plane);
    double angle = face.whole ? 2 * kPi : 0;
    if (face.ends > 0) {
      angle = std::atan2(face.arc.im, face.arc.re);
      if (angle < 0) angle += 2 * kPi;
    }
    const double cosine = cell.plane[plane].cosine;
    areas[plane] += 0.5 * angle * (1 - cosine) * (1 + cosine);
  }
}

}  // namespace vdwmesh::arcs
