// The lens of a boundary piece: the part of the plane between the piece, which is straight there,
// and the image of its arc, which is a circle's. For host and device.
#pragma once

#include <algorithm>
#include <cmath>

#include "creases/plane/stereographic.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh {

class PieceLens {
 public:
  // The piece runs from the unit vector `a` to `b`, at most an eighth of a turn of its circle, and
  // bulges as BoundaryPiece says: `bulge` is positive if the arc is on the left of the chord.
  //
  // Two points of the arc are its ends; the third is its middle, at the angle s from the middle of
  // the great circle between them. Project from the point opposite to that: the ends come to
  // ±tan(h/2), for h half of the angle between them, the great circle becomes the line through
  // them, and the arc that of a circle which meets the line at the angle β between arc and great
  // circle. Such an arc has the height tan(s/2) = tan(h/2) tan(β/2).
  VDWMESH_HD PieceLens(const Vec3d& a, const Vec3d& b, double bulge,
                       const Stereographic& projection)
      : a_(projection.project(a)), b_(projection.project(b)) {
    const double sine = norm(b - a) / 2, cosine = std::sqrt((1 - sine) * (1 + sine));
    const double tangent = tangent_of_bulge(sine, bulge);
    const double t = sine / (1 + cosine) * (tangent / (1 + std::sqrt(1 + tangent * tangent)));
    const Vec3d middle = (1 - t * t) * unit(a + b) + 2 * t * unit(cross(a, b - a));
    const ViewAngle view = view_from(projection.project(unit(middle)));
    cross_ = view.cross;
    dot_ = view.dot;
  }

  // Whether q is in the lens. It is if it is on the same side of the piece as the arc, and sees the
  // piece under a wider angle than the arc does. Of two angles with positive sines the one with the
  // smaller cotangent is wider.
  VDWMESH_HD bool contains(const PlanePoint& q) const {
    const ViewAngle view = view_from(q);
    return view.cross * cross_ > 0 && view.dot * std::abs(cross_) < dot_ * std::abs(view.cross);
  }

  // A disk around the middle of the piece that has the lens in it: the one above the piece, or, if
  // the arc is more than half of its circle in the plane, one that comes to the middle of the arc.
  PlanePoint center() const { return {(a_.x + b_.x) / 2, (a_.y + b_.y) / 2}; }
  double radius() const {
    const double half = std::hypot(b_.x - a_.x, b_.y - a_.y) / 2;
    if (cross_ == 0) return half;
    return half * std::max(1.0, (std::hypot(dot_, cross_) + dot_) / std::abs(cross_));
  }

 private:
  // The angle under which a point sees the piece: its cosine and sine times the same length. The
  // sine has the sign of the side.
  struct ViewAngle {
    double dot, cross;
  };
  VDWMESH_HD ViewAngle view_from(const PlanePoint& q) const {
    const double ax = a_.x - q.x, ay = a_.y - q.y, bx = b_.x - q.x, by = b_.y - q.y;
    return {ax * bx + ay * by, ax * by - ay * bx};
  }

  // tan β. For half of the piece's turn, y, on a circle of angular radius r, tan β is tan y cos r;
  // `bulge` is y cos r, and `sine`, half of the chord, is sin y sin r. So y² = bulge² + sine² (y /
  // sin y)². As y is at most π/8, each step below leaves 6 % of the error of y², or less, and of
  // the series the terms that are left out are 10⁻⁵ of the value.
  VDWMESH_HD static double tangent_of_bulge(double sine, double bulge) {
    double z = bulge * bulge + sine * sine;  // y²
    for (int i = 0; i < 4; ++i) {
      z = bulge * bulge + sine * sine * (1 + z * (1. / 3 + z * (1. / 15 + z * (2. / 189))));
    }
    return bulge * (1 + z * (1. / 3 + z * (2. / 15 + z * (17. / 315))));
  }

  PlanePoint a_, b_;
  double dot_, cross_;  // of the middle of the arc
};

}  // namespace vdwmesh
