// face_area(): clips a square around the disk by the half-spaces, and measures polygon ∩ disk. Both
// are in the plane of the disk, in coordinates from the disk's centre: a point is cosine · axis + x
// first + y second, and the radius of the disk is the sine, at most 1.
//
// The area depends continuously on all planes, so it needs no decisions about which of them meet.
#include "excluded/patches/cap_face.hpp"

#include "excluded/patches/share_formulas.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh::excluded {
namespace {

// The polygon's part with normal · point <= height.
std::vector<FacePoint> clip(const std::vector<FacePoint>& polygon, const FacePoint& normal,
                            double height) {
  std::vector<FacePoint> out;
  clip_polygon(polygon.data(), polygon.size(), normal, height,
               [&](const FacePoint& point) { out.push_back(point); });
  return out;
}

}  // namespace

double face_area(const Vec3d& axis, double cosine, std::span<const HalfSpace> within) {
  const Vec3d first = any_orthogonal(axis), second = cross(axis, first);
  std::vector<FacePoint> polygon{{-2, -2}, {2, -2}, {2, 2}, {-2, 2}};  // holds any such disk
  for (const HalfSpace& h : within) {
    polygon = clip(polygon, {dot(h.normal, first), dot(h.normal, second)},
                   h.height - cosine * dot(h.normal, axis));
  }
  const double squared_radius = (1 - cosine) * (1 + cosine);
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    area += triangle_in_disk(polygon[i], polygon[(i + 1) % polygon.size()], squared_radius);
  }
  return area;
}

}  // namespace vdwmesh::excluded
