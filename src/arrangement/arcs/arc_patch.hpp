// The corners of the exposed patch: area of the spherical polygon through them, turning angles.
//
// The polygon P of arc_measure.hpp is divided into triangles. One has the corners axis a, corner,
// axis b, for each corner. The others have the corners pole, axis a, axis b and close the polygon
// about an arbitrary pole. By Van Oosterom and Strackee 1983, "The solid angle of a plane
// triangle", unit vectors u, v, w span the solid angle
//   2 arg(1 + u·v + v·w + w·u + i det(u, v, w)),
// so products of such complex numbers add up areas.
#pragma once

#include "arrangement/arcs/arc_cell.hpp"

namespace vdwmesh::arcs {

// The argument of z in [0, 2 pi).
inline double argument(const Complex& z) {
  const double angle = std::atan2(z.im, z.re);
  return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

// Multiplies, and brings the size of the product back to 1 before it can over- or underflow.
inline void multiply(Complex& product, const Complex& factor) {
  product = product * factor;
  const double size = product.re * product.re + product.im * product.im;
  if (size > 1e100 || size < 1e-100) {
    const double scale = 1 / std::sqrt(size);
    product = {product.re * scale, product.im * scale};
  }
}

// Running products and sums over the edges with corners.
struct PatchSums {
  Complex polygon{1, 0};       // its argument is half the polygon's area
  Complex turning{1, 0};       // its argument is the sum of the turning angles
  Vec3d open{0, 0, 0};         // twice the vector area of the body's surface; 0 if it is closed
  double condition = 1;        // sum of the condition numbers of all angles
  double worst = 1;            // the largest condition number of a corner
  bool pole_too_near = false;  // to the antipode of an axis
};

// Poles to try in turn. A pole opposite to an axis is bad: the triangle's area is not determined
// there. The directions have no symmetry, so that in a lattice at most one of them is bad.
inline constexpr int kPoleCount = 4;
inline constexpr double kPoleDistance = 1e-4;  // least 1 + cosine: 0.8 degrees from the antipode
inline Vec3d pole(int attempt) {
  if (attempt == 0) return {0.36, 0.48, 0.80};
  if (attempt == 1) return {-0.48, 0.60, 0.64};
  if (attempt == 2) return {0.28, -0.768, -0.576};
  return {-0.6, -0.48, -0.64};
}

// Multiplies in the triangle pole, axis a, axis b, with its sign for the end that is a corner.
inline void add_pole_triangle(const CellEdge& e, const Vec3d& axis_a, const Vec3d& axis_b,
                              const Vec3d& p, PatchSums& sums) {
  const double pa = inner(p, axis_a), pb = inner(p, axis_b);
  if (1 + pa < kPoleDistance || 1 + pb < kPoleDistance) sums.pole_too_near = true;
  const double volume = inner(p, e.half) / e.scale;
  const Complex z{1 + pa + pb + e.cosine, volume};
  multiply(sums.polygon, e.exposed == kUpperEnd ? z : conjugate(z));
}

// Adds the corners at the ends of edge e. The Gram determinant gives det(axis_a, axis_b, corner) =
// ±root; the turning angle is that between the normals axis_a × corner and axis_b × corner, with
// cosine : sine = c - t_a t_b : root. If both ends are corners, the two pole triangles cancel.
inline void add_corners(const BallCell& cell, const CellEdge& e, const Vec3d& p, PatchSums& sums) {
  const Cap& a = cell.face_at(e.a).cap;
  const Cap& b = cell.face_at(e.b).cap;
  const Complex triangle{1 + a.cosine + b.cosine + e.cosine, -e.root};
  const Complex turn{e.cosine - a.cosine * b.cosine, e.root};
  const int corners = end_count(e.exposed);
  for (int i = 0; i < corners; ++i) {
    multiply(sums.polygon, triangle);
    multiply(sums.turning, turn);
  }
  // The angles lose digits if the circles are nearly tangent or a cap is nearly the whole sphere.
  const double condition = 1 / e.root + 1 / (1 + a.cosine) + 1 / (1 + b.cosine);
  sums.condition += corners * condition;
  sums.worst = condition > sums.worst ? condition : sums.worst;
  if (corners == 1) add_pole_triangle(e, a.axis, b.axis, p, sums);
}

// Sums over all corners, with the first pole that is far enough from the antipodes of the axes. If
// no pole is, the result says so in pole_too_near.
inline PatchSums sum_patch(const BallCell& cell) {
  PatchSums sums;
  for (int attempt = 0; attempt < kPoleCount; ++attempt) {
    sums = {};
    for (std::uint32_t i = 0; i < cell.edge_count(); ++i) {
      if (cell.edge(i).exposed) add_corners(cell, cell.edge(i), pole(attempt), sums);
    }
    if (!sums.pole_too_near) break;
  }
  return sums;
}

// Whether an end of the edge that is no corner lies nearly on the sphere, so that a third circle
// covers it by less than kTouching.
inline bool ends_near_sphere(const CellEdge& e) {
  return (!(e.exposed & kUpperEnd) && e.upper > 1 - kTouching) ||
         (!(e.exposed & kLowerEnd) && e.lower < -1 + kTouching);
}

// Whether a corner of the edge lies on the circle of a third cap, to kTouching. It looks at every
// cap, because the face of that cap may have been dropped.
inline bool touches_third(const BallCell& cell, const CellEdge& e, const Cap* caps,
                          std::uint32_t count) {
  const Cap& a = cell.face_at(e.a).cap;
  const Cap& b = cell.face_at(e.b).cap;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double room = caps[i].cosine - inner(caps[i].axis, e.middle);
    const double slope = inner(caps[i].axis, e.half);
    const bool near = ((e.exposed & kUpperEnd) && std::abs(room - slope) < kTouching) ||
                      ((e.exposed & kLowerEnd) && std::abs(room + slope) < kTouching);
    if (near && !same_cap(caps[i], a) && !same_cap(caps[i], b)) return true;
  }
  return false;
}

}  // namespace vdwmesh::arcs
