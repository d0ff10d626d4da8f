// Frames a surface exactly, by its support function.
//
// The support function gives, for any direction d, how far the surface reaches: the largest d·p of
// its points p. Framing needs nothing else, so it never looks at vertices. An orthographic camera
// follows from the box along the view's axes. A perspective camera follows from four support
// values, one for each side plane of the view frustum. The principal axes are the eigenvectors of
// the covariance of the surface's area, computed with Eigen.
//
// View coordinates x, y, z are measured along Camera::axes from Camera::origin, which is the middle
// of that box: x to the right, y up, z toward the viewer.
#include "render/camera.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

// Two spreads (eigenvalues of the covariance, Å²) count as equal if they differ by at most this
// share of the largest spread. The distances by which the surface extends to both sides of its
// middle count as equal if they differ by at most this share of their sum.
constexpr double kSameSpread = 1e-6;

// Bounds the magnification of a needle, a thin surface that points at the viewer. It is a share of
// half the surface's extent along z. In an orthographic picture the half height of the picture is
// at least this share, and in a perspective picture the eye is at least this far from the surface.
// Without a bound, the magnification would have no limit.
constexpr double kNeedleShare = 0.05;

Vec3d unit(const Vec3d& v) { return (1 / norm(v)) * v; }

// The vector that has the components v along the axes.
Vec3d combine(const Axes& axes, const Vec3d& v) {
  return v.x * axes[0] + v.y * axes[1] + v.z * axes[2];
}

// The component of largest magnitude, with its sign.
double largest_component(const Vec3d& v) {
  double largest = v.x;
  for (const double c : {v.y, v.z}) {
    if (std::abs(c) > std::abs(largest)) largest = c;
  }
  return largest;
}

// Returns the axis or its opposite, whichever points to the side on which the surface extends
// farther from its middle, the centroid. If both sides are equal, the largest component of the
// result is positive, so that rounding does not decide.
Vec3d oriented(const SurfaceExtent& surface, const Vec3d& middle, const Vec3d& axis) {
  const Vec3d both[] = {axis, -1.0 * axis};
  const std::vector<double> reach = surface.support(both);
  const double ahead = reach[0] - dot(axis, middle), behind = reach[1] + dot(axis, middle);
  const bool even = std::abs(ahead - behind) <= kSameSpread * (ahead + behind);
  const bool keep = even ? largest_component(axis) > 0 : ahead > behind;
  return keep ? both[0] : both[1];
}

// The interval that a surface covers along an axis, Å.
struct Range {
  double lower, upper;
  double middle() const { return (lower + upper) / 2; }
  double half() const { return (upper - lower) / 2; }
};

// The box around the surface along the axes.
std::array<Range, 3> ranges(const SurfaceExtent& surface, const Axes& axes) {
  const Vec3d directions[] = {axes[0],        axes[1],        axes[2],
                              -1.0 * axes[0], -1.0 * axes[1], -1.0 * axes[2]};
  const std::vector<double> reach = surface.support(directions);
  return {Range{-reach[3], reach[0]}, Range{-reach[4], reach[1]}, Range{-reach[5], reach[2]}};
}

// Sets the near and far plane, given the distance from the eye to the front of the surface and the
// extent of the surface along z, Å. The planes lie a little in front of and behind the surface, so
// that rounding clips nothing. The distance of the near plane from the eye is at least half of
// eye_to_front, so it stays above 0.
void set_depth(Camera& camera, double eye_to_front, double depth) {
  const double slack = 1e-3 * (depth + eye_to_front);
  camera.nearest = std::max(eye_to_front - slack, 0.5 * eye_to_front);
  camera.farthest = eye_to_front + depth + slack;
}

// Fits the box into the picture's width and height; `aspect` is width over height, and `fill` the
// share of the picture inside the margins. The distance of the eye changes nothing in an
// orthographic picture. The eye is in front of the surface by half the surface's depth or half the
// picture's height, whichever is larger.
void frame_orthographic(Camera& camera, const std::array<Range, 3>& box, double aspect,
                        double fill) {
  const double seen = std::max(box[1].half(), box[0].half() / aspect);
  camera.half_height = std::max(seen, kNeedleShare * box[2].half()) / fill;
  camera.half_width = camera.half_height * aspect;
  const double size = std::max(box[2].half(), camera.half_height);
  camera.eye = {0, 0, box[2].half() + size};
  set_depth(camera, size, 2 * box[2].half());
}

// Finds the nearest eye that sees the whole surface within the margins. Let w and h be half the
// width and height inside the margins at distance 1 from the eye. A point lies inside the right
// edge if x - eye.x <= w (eye.z - z), that is, if x + w z <= w eye.z + eye.x. The largest value of
// the left side is the support of direction (1, 0, w). The left edge of the picture gives a bound
// with (-1, 0, w), and the sum of the two bounds is a lower bound of 2 w eye.z. Top and bottom give
// a lower bound of 2 h eye.z. The larger distance decides, and half the differences of opposite
// bounds centre the surface in both directions.
void frame_perspective(Camera& camera, const SurfaceExtent& surface,
                       const std::array<Range, 3>& box, double aspect, double fill) {
  camera.half_height = std::tan(kVerticalFieldOfView * std::numbers::pi / 360);
  camera.half_width = camera.half_height * aspect;
  const double w = camera.half_width * fill, h = camera.half_height * fill;
  const Axes& a = camera.axes;
  const Vec3d directions[] = {w * a[2] + a[0], w * a[2] - a[0], h * a[2] + a[1], h * a[2] - a[1]};
  std::vector<double> bound = surface.support(directions);
  // support() measures from the coordinate origin; this changes to view coordinates.
  for (std::size_t i = 0; i < bound.size(); ++i) bound[i] -= dot(directions[i], camera.origin);
  const double distance =
      std::max({(bound[0] + bound[1]) / (2 * w), (bound[2] + bound[3]) / (2 * h),
                (1 + kNeedleShare) * box[2].half()});
  camera.eye = {(bound[0] - bound[1]) / 2, (bound[2] - bound[3]) / 2, distance};
  set_depth(camera, distance - box[2].half(), 2 * box[2].half());
}

}  // namespace

Axes principal_axes(const SurfaceExtent& surface) {
  const SurfaceExtent::Moments moments = surface.moments();
  const auto& c = moments.covariance;
  Eigen::Matrix3d matrix;
  matrix << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
  const Eigen::Vector3d& spread = solver.eigenvalues();  // Å², ascending
  if (spread[2] - spread[0] <= kSameSpread * spread[2]) {
    return {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  }
  const auto axis = [&](int i) {
    const Eigen::Vector3d v = solver.eigenvectors().col(i);
    return oriented(surface, moments.middle, unit({v[0], v[1], v[2]}));
  };
  const Vec3d first = axis(2), second = axis(1);
  return {first, second, unit(cross(first, second))};
}

Axes view_axes(const View& view, const SurfaceExtent& surface) {
  const auto usable = [](const Vec3d& v) { return std::isfinite(norm(v)) && norm(v) > 0; };
  constexpr double kLeastSine = 1e-6;  // between the two directions
  if (!usable(view.toward_viewer) || !usable(view.up) ||
      norm(cross(unit(view.up), unit(view.toward_viewer))) < kLeastSine) {
    throw InvalidInput("a view needs two finite directions, to the viewer and up, not parallel");
  }
  Axes frame = {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  if (view.frame == ViewFrame::principal) frame = principal_axes(surface);
  const Vec3d back = unit(combine(frame, view.toward_viewer));
  const Vec3d right = unit(cross(unit(combine(frame, view.up)), back));
  return {right, cross(back, right), back};
}

Camera frame_surface(const SurfaceExtent& surface, const View& view, CameraProjection projection,
                     double aspect, double margin) {
  Camera camera;
  camera.projection = projection;
  camera.axes = view_axes(view, surface);
  const std::array<Range, 3> box = ranges(surface, camera.axes);
  if (!(std::max({box[0].half(), box[1].half(), box[2].half()}) > 0)) {
    throw InvalidInput("the surface is a single point; there is nothing to see");
  }
  camera.origin = combine(camera.axes, {box[0].middle(), box[1].middle(), box[2].middle()});
  const double fill = 1 - 2 * margin;
  if (projection == CameraProjection::orthographic) {
    frame_orthographic(camera, box, aspect, fill);
  } else {
    frame_perspective(camera, surface, box, aspect, fill);
  }
  return camera;
}

std::array<double, 16> clip_matrix(const Camera& camera) {
  const double n = camera.nearest, f = camera.farthest;
  const bool perspective = camera.projection == CameraProjection::perspective;
  // Clip coordinates are linear in the depth d = eye.z - z: clip z = slope · d + offset, and w is d
  // for a perspective picture, else 1. `slope` and `offset` make z / w = -1 for d = n and 1 for
  // d = f. The array lists the matrix column by column: the factors of x, y and z of a point
  // relative to camera.origin, then the constants.
  const double slope = perspective ? (f + n) / (f - n) : 2 / (f - n);
  const double offset = perspective ? -2 * f * n / (f - n) : -(f + n) / (f - n);
  const Vec3d x = (1 / camera.half_width) * camera.axes[0];
  const Vec3d y = (1 / camera.half_height) * camera.axes[1];
  const Vec3d z = -slope * camera.axes[2];
  const Vec3d w = perspective ? -1.0 * camera.axes[2] : Vec3d{0, 0, 0};
  const Vec3d& e = camera.eye;
  return {x.x,
          y.x,
          z.x,
          w.x,
          x.y,
          y.y,
          z.y,
          w.y,
          x.z,
          y.z,
          z.z,
          w.z,
          -e.x / camera.half_width,
          -e.y / camera.half_height,
          slope * e.z + offset,
          perspective ? e.z : 1};
}

Vec3d project(const Camera& camera, const Vec3d& point) {
  const std::array<double, 16> m = clip_matrix(camera);
  const Vec3d p = point - camera.origin;
  // Row i of the matrix times the point; the matrix is stored column by column.
  const auto row = [&](std::size_t i) {
    return m[i] * p.x + m[4 + i] * p.y + m[8 + i] * p.z + m[12 + i];
  };
  const double w = row(3);
  return {row(0) / w, row(1) / w, row(2) / w};
}

}  // namespace vdwmesh
