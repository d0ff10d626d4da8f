// The corners of the exposed patch: the spherical polygon through them, and the turning angles.
#pragma once

#include "arrangement/arcs/arc_cell.hpp"

namespace vdwmesh::arcs {

inline constexpr double kPi = 3.14159265358979323846;

VDWMESH_HD inline double argument(const Complex& z) {
  const double angle = std::atan2(z.im, z.re);
  return angle < 0 ? angle + 2 * kPi : angle;
}

VDWMESH_HD inline void multiply(Complex& product, const Complex& factor) {
  product = product * factor;
  const double size = product.re * product.re + product.im * product.im;
  if (size > 1e100 || size < 1e-100) {
    const double scale = 1 / std::sqrt(size);
    product = {product.re * scale, product.im * scale};
  }
}

// Running products and sums over the edges.
struct PatchSums {
  Complex polygon{1, 0};  // half the polygon's area
  Complex turning{1, 0};  // turning angles
  Vec3d open{0, 0, 0};    // twice the vector area of the closed body's surface
  double condition = 1;   // roundings of all angles together, in units of one
  double worst = 1;       // of a single corner's
  bool pole_too_near = false;
};

// A pole for the triangles pole-axis-axis of the polygon; bad when opposite to one of the axes.
// Directions without symmetry, so that no lattice is bad for more than one of them.
inline constexpr int kPoleCount = 4;
inline constexpr double kPoleDistance = 1e-4;
VDWMESH_HD inline Vec3d pole(int attempt) {
  if (attempt == 0) return {0.36, 0.48, 0.80};
  if (attempt == 1) return {-0.48, 0.60, 0.64};
  if (attempt == 2) return {0.28, -0.768, -0.576};
  return {-0.6, -0.48, -0.64};
}

// Twice tan of half the triangle's area as re, im (Van Oosterom and Strackee 1983).
VDWMESH_HD inline void add_pole_triangle(const CellEdge& e, const Vec3d& axis_a,
                                         const Vec3d& axis_b, const Vec3d& p, PatchSums& sums) {
  const double pa = inner(p, axis_a), pb = inner(p, axis_b);
  if (1 + pa < kPoleDistance || 1 + pb < kPoleDistance) sums.pole_too_near = true;
  const double volume = inner(p, e.half) / e.scale;
  const Complex z{1 + pa + pb + e.cosine, volume};
  multiply(sums.polygon, e.exposed == kUpperEnd ? z : conjugate(z));
}

VDWMESH_HD inline void add_corners(const BallCell& cell, const CellEdge& e, const Vec3d& p,
                                   PatchSums& sums) {
  const Cap& a = cell.face_at(e.a).cap;
  const Cap& b = cell.face_at(e.b).cap;
  const Complex triangle{1 + a.cosine + b.cosine + e.cosine, -e.root};
  const Complex turn{e.cosine - a.cosine * b.cosine, e.root};
  const int corners = end_count(e.exposed);
  for (int i = 0; i < corners; ++i) {
    multiply(sums.polygon, triangle);
    multiply(sums.turning, turn);
  }
  const double condition = 1 / e.root + 1 / (1 + a.cosine) + 1 / (1 + b.cosine);
  sums.condition += corners * condition;
  sums.worst = condition > sums.worst ? condition : sums.worst;
  if (corners == 1) add_pole_triangle(e, a.axis, b.axis, p, sums);
}

// Over all corners, from a pole that is far enough from the antipodes of the axes.
VDWMESH_HD inline PatchSums sum_patch(const BallCell& cell) {
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

// Whether an end that is no corner all but reaches the sphere: a third circle only just covers it.
VDWMESH_HD inline bool ends_near_sphere(const CellEdge& e) {
  return (!(e.exposed & kUpperEnd) && e.upper > 1 - kTouching) ||
         (!(e.exposed & kLowerEnd) && e.lower < -1 + kTouching);
}

// Whether a corner lies on the circle of a third cap, also of one long dropped.
VDWMESH_HD inline bool touches_third(const BallCell& cell, const CellEdge& e, const Cap* caps,
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
