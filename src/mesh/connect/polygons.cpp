// Polygons to triangles: fans, and ear clipping for polygons whose fan folds over. A fan is right
// for convex polygons and costs nothing, so finish() tests every fan by the signs of its triangles'
// areas and clips only those that fail. Polygons that cross themselves have no triangulation; they
// keep their fan, and a note says so.
#include "mesh/connect/polygons.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace vdwmesh::formats {
namespace {

// Polygons with more corners are not clipped. To clip n corners takes O(n^2) time, and O(n^3) if
// most tests for an ear fail: then 500 corners cost about 10^8 steps, about a second. The limit
// keeps a hostile polygon from taking hours.
constexpr std::uint32_t kMostCorners = 500;
// Relative to the polygon's area. A triangle whose signed area is negative by less than this counts
// as flat: rounding of its coordinates in double can produce such a value. Areas are positive if
// the triangle turns the same way as the polygon.
constexpr double kFlat = 1e-12;

struct Point2 {
  double x, y;
};

bool same(const Point2& a, const Point2& b) { return a.x == b.x && a.y == b.y; }

// Twice the signed area of a triangle: positive if a, b, c turn left.
double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The corners of the polygon of which a fan was made, as vertex indices. The fan begins with
// triangle `first`. Its triangle i is (corner 0, corner i + 1, corner i + 2).
std::vector<std::uint32_t> corners_of(const IndexedMesh& mesh, std::size_t first,
                                      std::uint32_t count) {
  std::vector<std::uint32_t> corners{mesh.triangles[first][0], mesh.triangles[first][1]};
  for (std::size_t t = first; corners.size() < count; ++t) corners.push_back(mesh.triangles[t][2]);
  return corners;
}

// Twice the area vector of triangle t: it is normal to the triangle, and its length is twice the
// area.
Vec3d area_vector(const IndexedMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
}

// Twice the area vector of the polygon of a fan, as the sum over the triangles. It does not depend
// on the triangulation and is defined for corners that lie in no plane (Newell's method).
Vec3d area_vector(const IndexedMesh& mesh, std::size_t first, std::uint32_t corners) {
  Vec3d sum{0, 0, 0};
  for (std::size_t t = first; t < first + corners - 2; ++t) sum = sum + area_vector(mesh, t);
  return sum;
}

// Whether a triangle of the fan faces away from the polygon, so that triangles overlap. If the area
// vector is zero, nothing can face away from it, so the answer is no.
bool folds_over(const IndexedMesh& mesh, std::size_t first, std::uint32_t corners,
                const Vec3d& area) {
  for (std::size_t t = first; t < first + corners - 2; ++t)
    if (dot(area_vector(mesh, t), area) < -kFlat * squared_norm(area)) return true;
  return false;
}

// Triangulates one polygon. An ear is a convex corner whose triangle with its two neighbours holds
// no other corner. Ears are cut off until a triangle is left. Every simple polygon of more than
// three corners has two ears (Meisters 1975). So, rounding aside, the search fails only if the
// polygon is not simple.
class EarClipper {
 public:
  // Projects the corners onto the plane normal to `area`, which is twice the polygon's area vector
  // and not zero. In the plane's axes u and v the polygon runs counter-clockwise. `aside` is a
  // coordinate axis at least 36 degrees away from the normal: the x axis if |normal.x| < 0.6, and
  // otherwise the y axis, since then |normal.y| <= 0.8. The length of u is the sine of this angle,
  // 0.6 to 1. v has the same length. Areas in the plane are scaled by the square of the length,
  // which does not change their signs.
  EarClipper(const IndexedMesh& mesh, std::vector<std::uint32_t> corners, const Vec3d& area)
      : corners_(std::move(corners)), flat_(kFlat * norm(area)) {
    const Vec3d normal = (1 / norm(area)) * area;
    const Vec3d aside = std::abs(normal.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d u = cross(aside, normal), v = cross(normal, u);
    const Vec3d origin = mesh.positions[corners_[0]];
    for (const std::uint32_t corner : corners_) {
      const Vec3d p = mesh.positions[corner] - origin;
      points_.push_back({dot(p, u), dot(p, v)});
    }
  }

  // Appends the triangles. Returns false if the polygon crosses itself: then no ear is found, or
  // the last triangle is turned over (has a negative area). `triangles` is of no use then.
  bool clip(std::vector<Triangle>& triangles) {
    std::size_t at = 0;  // the corner to try next; after a cut, the one that follows the ear
    while (corners_.size() > 3) {
      const std::size_t size = corners_.size();
      std::size_t tried = 0;
      while (tried < size && !is_ear(at)) {
        at = next(at);
        ++tried;
      }
      if (tried == size) return false;
      cut(at, triangles);
      at = at % corners_.size();  // 0 if the ear was the last corner
    }
    triangles.push_back({corners_[0], corners_[1], corners_[2]});
    return turn(points_[0], points_[1], points_[2]) >= -flat_;
  }

 private:
  // Neighbours of corner i in the cyclic order of the corners that are left.
  std::size_t next(std::size_t i) const { return i + 1 == corners_.size() ? 0 : i + 1; }
  std::size_t before(std::size_t i) const { return i == 0 ? corners_.size() - 1 : i - 1; }

  // Whether corner i is convex and its triangle, with its edges, holds no other corner. A corner at
  // the same point as one of the three does not count: a polygon with a hole runs to the hole and
  // back along the same line, so it has corners twice.
  bool is_ear(std::size_t i) const {
    const std::size_t h = before(i), j = next(i);
    const Point2 &a = points_[h], &b = points_[i], &c = points_[j];
    if (!(turn(a, b, c) > 0)) return false;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const Point2& p = points_[k];
      if (same(p, a) || same(p, b) || same(p, c)) continue;
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
  }

  // Cuts off the ear at corner i.
  void cut(std::size_t i, std::vector<Triangle>& triangles) {
    triangles.push_back({corners_[before(i)], corners_[i], corners_[next(i)]});
    corners_.erase(corners_.begin() + static_cast<std::ptrdiff_t>(i));
    points_.erase(points_.begin() + static_cast<std::ptrdiff_t>(i));
  }

  std::vector<std::uint32_t> corners_;  // vertices of the corners that are left
  std::vector<Point2> points_;          // where these corners lie in the plane
  double flat_;  // the largest turn(), in absolute value, of a triangle that counts as flat
};

}  // namespace

void Polygons::add(IndexedMesh& mesh, const std::vector<std::uint32_t>& corners) {
  if (corners.size() < 3) ++too_few_;
  if (corners.size() > 3)
    fans_.push_back({mesh.triangle_count(), static_cast<std::uint32_t>(corners.size())});
  for (std::size_t i = 2; i < corners.size(); ++i)
    mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

void Polygons::finish(MeshFile& file) {
  std::uint64_t clipped = 0, folded = 0;
  for (const Fan& fan : fans_) {
    const Vec3d area = area_vector(file.mesh, fan.first, fan.corners);
    if (!folds_over(file.mesh, fan.first, fan.corners, area)) continue;
    std::vector<Triangle> triangles;
    const bool done =
        fan.corners <= kMostCorners &&
        EarClipper(file.mesh, corners_of(file.mesh, fan.first, fan.corners), area).clip(triangles);
    if (done)
      std::copy(triangles.begin(), triangles.end(),
                file.mesh.triangles.begin() + static_cast<std::ptrdiff_t>(fan.first));
    ++(done ? clipped : folded);
  }
  const auto note = [&](std::uint64_t count, std::string_view text) {
    if (count > 0) file.notes.push_back(fmt::format("{} {}", count, text));
  };
  note(fans_.size() - clipped - folded, "polygons were fanned into triangles");
  note(clipped, "concave polygons were cut into triangles by ear clipping");
  note(
      folded,
      "polygons that cross themselves, or are concave with more than 500 corners, were fanned into "
      "triangles that overlap: their area is too large");
  note(too_few_, "faces of fewer than three corners were left out");
  fans_ = {};
}

}  // namespace vdwmesh::formats
