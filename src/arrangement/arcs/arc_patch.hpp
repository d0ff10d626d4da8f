// The corners of the exposed patch: area of the spherical polygon through them, turning angles.
//
// The vertices of the polygon P of arc_measure.hpp are corners of the patch and, between two of
// them, the axis of a cap. P is divided into two spherical triangles with signed areas for each
// corner of circles a and b: one has the vertices axis a, corner, axis b, the other one the
// vertices pole, axis a, axis b, with a pole that is the same for all corners and otherwise
// arbitrary. By Van Oosterom and Strackee 1983, "The solid angle of a plane triangle", unit vectors
// u, v, w span the solid angle
//   2 arg(1 + u·v + v·w + w·u + i det(u, v, w)),
// so the argument of the product of such complex numbers is half the area of P, modulo 2 pi.
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
  double condition = 1;        // sum of the condition numbers of all corners' angles
  double worst = 1;            // the largest of these condition numbers, at least 1
  bool pole_too_near = false;  // the pole is too near to the antipode of an axis
};

// Poles to try in turn. A pole opposite to an axis is bad, because the great circle between them
// and so the triangle is not determined. The directions have no symmetry, so that in a lattice at
// most one of them is bad.
inline constexpr int kPoleCount = 4;
inline constexpr double kPoleDistance = 1e-4;  // least 1 + cosine: 0.8 degrees from the antipode
inline Vec3d pole(int attempt) {
  if (attempt == 0) return {0.36, 0.48, 0.80};
  if (attempt == 1) return {-0.48, 0.60, 0.64};
  if (attempt == 2) return {0.28, -0.768, -0.576};
  return {-0.6, -0.48, -0.64};
}

// Multiplies the triangle pole, axis a, axis b into the polygon. Precondition: exactly one end of
// the edge is a corner. The sign of the area is positive at the upper end, negative at the lower.
inline void add_pole_triangle(const CellEdge& e, const Vec3d& axis_a, const Vec3d& axis_b,
                              const Vec3d& p, PatchSums& sums) {
  const double pa = inner(p, axis_a), pb = inner(p, axis_b);
  if (1 + pa < kPoleDistance || 1 + pb < kPoleDistance) sums.pole_too_near = true;
  const double volume = inner(p, e.half) / e.scale;  // det(p, axis a, axis b)
  const Complex z{1 + pa + pb + e.cosine, volume};
  multiply(sums.polygon, e.exposed == kUpperEnd ? z : conjugate(z));
}

// Adds the corners at the ends of edge e. Precondition: there is at least one. Both kinds of corner
// give the same factors: det(axis_a, axis_b, corner) is root at the upper end and -root at the
// lower one, where a and b change roles. The turning angle lies between the normals axis_a × corner
// and axis_b × corner, with cosine : sine = c - t_a t_b : root. If both ends are corners, their two
// pole triangles have opposite signs and are left out.
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
  // The angles lose digits if the circles are nearly tangent (root is nearly 0) or a cap is nearly
  // the whole sphere (its cosine is nearly -1).
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

// Whether a third circle hides a would-be corner of the edge only just: an end that some plane has
// cut off lies nearly on the sphere, to kTouching as the parameter s.
inline bool ends_near_sphere(const CellEdge& e) {
  return (!(e.exposed & kUpperEnd) && e.upper > 1 - kTouching) ||
         (!(e.exposed & kLowerEnd) && e.lower < -1 + kTouching);
}

// Whether a third circle hides a corner of the edge almost: the corner is exposed and lies on the
// plane of a third cap, to kTouching. Looks at every cap of the ball, because caps that only touch
// the corner may have no face.
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
