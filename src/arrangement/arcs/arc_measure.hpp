// Area of the exposed patch and volume of the cut ball, from the edges of a BallCell.
// Let t be the cosine of a cap, phi the exposed angle of its circle, and P the spherical polygon
// that replaces each arc of the patch's boundary by two great-circle segments: from the arc's start
// to the point where the cap's axis meets the sphere, and from there to the arc's end.
//   area   = area(P) - sum phi (1 - t), modulo 4 pi       the patch is P without sectors of caps
//   area   = 2 pi chi + sum phi t - sum turning angles    Gauss-Bonnet: the check
//   volume = (area + sum t F) / 3, F = area of a face     divergence theorem about the centre
// Angles are added by multiplying complex numbers. This takes one arctangent for each exposed
// circle and two for the patch, and it needs no order of the corners along the patch.
#pragma once

#include "arrangement/arcs/arc_patch.hpp"

namespace vdwmesh::arcs {

struct BallMeasures {
  double area, volume;   // of the exposed patch; of the cut ball. The radius is 1.
  std::uint32_t doubts;  // Doubt bits; 0: the numbers are good
};

// An exposed angle this near to 0 or 2 pi may be either, by rounding.
inline constexpr double kTinyAngle = 1e-9;
// An angle at a corner is taken to be wrong by its condition number times 64 machine epsilons.
inline constexpr double kRounding = 64 * 2.220446049250313e-16;
// Largest estimated rounding error of a corner's angle that is accepted, in radians.
inline constexpr double kMaxError = 1e-9;
// Largest accepted length of PatchSums::open, which is 0 if the surface is closed, up to rounding.
inline constexpr double kMaxOpen = 1e-10;

// The corner on the circle of `face` as a unit complex number. Its argument is the angle about the
// axis from `first`. The orthonormal basis first, second, axis depends on the axis alone (Duff et
// al. 2017, "Building an orthonormal basis, revisited").
inline Complex on_circle(const CellFace& face, const Vec3d& corner) {
  const auto [first, second] = frame_of(face.cap.axis);
  const double scale = 1 / std::sqrt(face.squared_sine);
  return {scale * inner(first, corner), scale * inner(second, corner)};
}

// Adds an arc's end (direction 1) or start (-1) at the corner to the sums of the face, which cut()
// has set to their empty values. Arcs run counter-clockwise about the axis. The product of all ends
// and conjugated starts has the exposed angle of the circle as its argument.
inline void add_arc_end(CellFace& face, const Vec3d& corner, int direction) {
  const Complex place = on_circle(face, corner);
  multiply(face.arc, direction > 0 ? place : conjugate(place));
  face.balance += direction;
  ++face.ends;
}

// Adds the edge, middle + s half, to the sums of both faces and to PatchSums::open, which is twice
// the vector area. At its corner s = 1 an arc of circle a starts and one of b ends; at s = -1 it is
// the other way round.
// To PatchSums::open a face adds 2 F axis = (edge_moment + phi sine²) axis. The patch adds the
// integral of x × dx along its boundary, which runs against the arcs: for each arc
// t axis × (start - end) - phi sine² axis. The terms with phi cancel.
inline void add_edge(const BallCell& cell, const CellEdge& e, PatchSums& sums) {
  CellFace& a = cell.face_at(e.a);
  CellFace& b = cell.face_at(e.b);
  const double moment = e.scale * (e.upper - e.lower);  // length / sine; toward_*: sine × distance
  a.edge_moment += e.toward_b * moment;
  b.edge_moment += e.toward_a * moment;
  sums.open = sums.open + moment * (e.toward_b * a.cap.axis + e.toward_a * b.cap.axis);
  if (!e.exposed) return;
  const Vec3d arm = a.cap.cosine * a.cap.axis - b.cap.cosine * b.cap.axis;
  if (e.exposed & kUpperEnd) {
    const Vec3d corner = e.middle + e.half;
    add_arc_end(a, corner, -1);
    add_arc_end(b, corner, 1);
    sums.open = sums.open + cross(arm, corner);
  }
  if (e.exposed & kLowerEnd) {
    const Vec3d corner = e.middle - e.half;
    add_arc_end(a, corner, 1);
    add_arc_end(b, corner, -1);
    sums.open = sums.open - cross(arm, corner);
  }
}

// Sums over the faces of the cut ball.
struct FaceSums {
  double angle = 0;        // sum phi over the circles with corners
  double sector = 0;       // sum phi (1 - t) over all circles
  double pyramid = 0;      // sum t F
  double largest_cap = 0;  // area of the largest cap
  std::uint32_t doubts = 0;
};

inline void add_face_to(const CellFace& face, FaceSums& sums) {
  double angle = 0;  // exposed: all of a circle that no edge cuts, nothing of one without corners
  if (!face.crossed) {
    angle = 2 * std::numbers::pi;
  } else if (face.ends > 0) {
    angle = argument(face.arc);  // in [0, 2 pi)
    if (angle < kTinyAngle || angle > 2 * std::numbers::pi - kTinyAngle) sums.doubts |= kTinyArc;
    // Arcs without both a start and an end bound no patch, and the theorem says nothing of them.
    if (face.balance != 0) sums.doubts |= kGaussBonnet;
    sums.angle += angle;
  }
  const double drop = 1 - face.cap.cosine;
  sums.sector += angle * drop;
  sums.pyramid += face.cap.cosine * 0.5 * (face.squared_sine * angle + face.edge_moment);
  if (2 * std::numbers::pi * drop > sums.largest_cap)
    sums.largest_cap = 2 * std::numbers::pi * drop;
}

// Reduces an area modulo 4 pi. At most 4 pi - A can be exposed, with the area A of the largest cap.
// A remainder above 4 pi - A / 2 is an area of 0 with a negative rounding error, which is returned.
inline double reduce_area(double area, double largest_cap) {
  const double full = 4 * std::numbers::pi;
  area -= full * std::floor(area / full);
  return area > full - 0.5 * largest_cap ? area - full : area;
}

// Measures the cut ball and checks the result. `caps`: all caps of the ball. May be called only
// once for each cell, since it adds to the sums that stand in the faces.
inline BallMeasures measure_cell(const BallCell& cell, const Cap* caps, std::uint32_t count) {
  if (cell.empty()) return {0, 0, cell.doubts()};
  std::uint32_t doubts = cell.doubts();
  PatchSums patch = sum_patch(cell);
  if (patch.pole_too_near) doubts |= kIllConditioned;
  for (std::uint32_t i = 0; i < cell.edge_count(); ++i) {
    const CellEdge& e = cell.edge(i);
    add_edge(cell, e, patch);
    if (ends_near_sphere(e) || (e.exposed && touches_third(cell, e, caps, count))) {
      doubts |= kThirdCircle;
    }
  }
  FaceSums faces;
  for (std::uint32_t i = 0; i < cell.face_count(); ++i) add_face_to(cell.face(i), faces);
  doubts |= faces.doubts;

  // Without corners the patch is the sphere less whole disks, or nothing.
  double area = cell.closed() ? 0 : 4 * std::numbers::pi - faces.sector;
  if (cell.has_corners()) {
    const double polygon = 2 * argument(patch.polygon);  // the product holds half the area
    area = reduce_area(polygon - faces.sector, faces.largest_cap);
    // Both formulas for the area give area(P) - sum phi + sum turning = 2 pi chi, modulo 2 pi, so
    // the left side has to be a multiple of 2 pi.
    const double turns = (polygon - faces.angle + argument(patch.turning)) / (2 * std::numbers::pi);
    const double miss = 2 * std::numbers::pi * std::abs(turns - std::round(turns));
    if (!(miss <= kRounding * patch.condition)) doubts |= kGaussBonnet;
  }
  if (!(kRounding * patch.worst <= kMaxError)) doubts |= kIllConditioned;
  if (!(inner(patch.open, patch.open) <= kMaxOpen * kMaxOpen)) doubts |= kOpenSurface;
  const double volume = (area + faces.pyramid) / 3;
  const double most = 4 * std::numbers::pi + kMaxError;  // no area or volume of a ball is larger
  if (!(std::abs(area) <= most && std::abs(volume) <= most)) doubts |= kNotFinite;  // NaN too
  return {area, volume, doubts};
}

}  // namespace vdwmesh::arcs
