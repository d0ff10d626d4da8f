#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <unordered_map>

#include "support/crease_survey.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

double angle_between(const Vec3d& a, const Vec3d& b) {
  return kDegrees * std::atan2(norm(cross(a, b)), dot(a, b));
}

// Along the circle of two spheres at p, to the side of `toward`.
Vec3d circle_tangent(const Sphere& a, const Sphere& b, const Vec3d& p, const Vec3d& toward) {
  const Vec3d along = cross(b.center - a.center, p - a.center);
  return dot(along, toward - p) < 0 ? -1.0 * along : along;
}

// Corner k of triangle t: counter-clockwise from `first` to `second` around the vertex.
struct Wedge {
  std::size_t triangle, k;
  std::uint32_t first, second;
  SphereId sphere;
  double floor;
};

// Sets the floors of the triangles' angles at one vertex with three arcs or more.
class CornerFloors {
 public:
  CornerFloors(const SphereSet& spheres, const IndexedMesh& mesh, std::uint32_t vertex,
               std::vector<Wedge>& wedges)
      : spheres_(spheres), mesh_(mesh), vertex_(vertex), wedges_(wedges) {}

  // Returns the sharpest corner, degrees.
  double set() {
    double sharpest = 360;
    for (std::size_t w = 0; w < wedges_.size(); ++w) {
      const Wedge* before = ending_at(wedges_[w].first);
      if (!before || before->sphere == wedges_[w].sphere) continue;
      sharpest = std::min(sharpest, set_fan(w, before->sphere));
    }
    return sharpest;
  }

 private:
  Wedge* starting_at(std::uint32_t v) {
    for (Wedge& w : wedges_)
      if (w.first == v) return &w;
    return nullptr;
  }
  const Wedge* ending_at(std::uint32_t v) const {
    for (const Wedge& w : wedges_)
      if (w.second == v) return &w;
    return nullptr;
  }

  // The fan of one patch that begins with this wedge, behind the patch of sphere `right`.
  double set_fan(std::size_t start, SphereId right) {
    std::vector<Wedge*> fan{&wedges_[start]};
    Wedge* next = starting_at(fan.back()->second);
    while (next && next->sphere == fan[0]->sphere && fan.size() < wedges_.size()) {
      fan.push_back(next);
      next = starting_at(fan.back()->second);
    }
    if (!next) return 360;
    const SphereId own = fan[0]->sphere;
    double exact = patch_corner_angle(spheres_[own], mesh_.positions[vertex_], spheres_[right],
                                      mesh_.positions[fan[0]->first], spheres_[next->sphere],
                                      mesh_.positions[fan.back()->second]);
    // An angle of nothing may come out as a whole turn.
    if (exact > 270 && flat_angle(fan) < 90) exact = 0;
    for (Wedge* w : fan) w->floor = std::min(kAngleFloor, exact / 2);
    return exact;
  }
  double flat_angle(const std::vector<Wedge*>& fan) const {
    double sum = 0;
    const Vec3d& p = mesh_.positions[vertex_];
    for (const Wedge* w : fan) {
      sum += angle_between(mesh_.positions[w->first] - p, mesh_.positions[w->second] - p);
    }
    return sum;
  }

  const SphereSet& spheres_;
  const IndexedMesh& mesh_;
  std::uint32_t vertex_;
  std::vector<Wedge>& wedges_;
};

bool is_corner(const IndexedMesh& mesh, std::uint32_t v) {
  return mesh.vertex_spheres[v][2] != kNoSphere;
}

std::array<double, 3> angles_of(const IndexedMesh& mesh, std::size_t t) {
  std::array<double, 3> angles{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto at = [&](std::size_t i) { return mesh.positions[mesh.triangles[t][(k + i) % 3]]; };
    angles[k] = angle_between(at(1) - at(0), at(2) - at(0));
  }
  return angles;
}

using Wedges = std::unordered_map<std::uint32_t, std::vector<Wedge>>;

Wedges wedges_at_corners(const IndexedMesh& mesh) {
  Wedges wedges;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& v = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      if (!is_corner(mesh, v[k])) continue;
      wedges[v[k]].push_back(
          {t, k, v[(k + 1) % 3], v[(k + 2) % 3], mesh.triangle_spheres[t], kAngleFloor});
    }
  }
  return wedges;
}

}  // namespace

double patch_corner_angle(const Sphere& sphere, const Vec3d& p, const Sphere& right,
                          const Vec3d& start, const Sphere& left, const Vec3d& end) {
  const Vec3d normal = (1 / sphere.radius) * (p - sphere.center);
  const Vec3d a = circle_tangent(sphere, right, p, start), b = circle_tangent(sphere, left, p, end);
  const double turn = kDegrees * std::atan2(dot(normal, cross(a, b)), dot(a, b));
  return turn < 0 ? turn + 360 : turn;
}

AngleCensus angle_census(const SphereSet& spheres, const IndexedMesh& mesh) {
  AngleCensus census;
  Wedges wedges = wedges_at_corners(mesh);
  std::unordered_map<std::size_t, double> floors;  // of angle 3 t + k, where it is not kAngleFloor
  for (auto& [vertex, around] : wedges) {
    const double sharpest = CornerFloors(spheres, mesh, vertex, around).set();
    census.sharpest_corner = std::min(census.sharpest_corner, sharpest);
    for (const Wedge& w : around) {
      if (w.floor < kAngleFloor) floors[3 * w.triangle + w.k] = w.floor;
    }
  }
  std::vector<double> least;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const std::array<double, 3> angles = angles_of(mesh, t);
    least.push_back(*std::min_element(angles.begin(), angles.end()));
    for (std::size_t k = 0; k < 3; ++k) {
      if (angles[k] >= kAngleFloor) continue;
      ++census.below_5_degrees;
      const auto own = floors.find(3 * t + k);
      const double floor = own == floors.end() ? kAngleFloor : own->second;
      if (!(angles[k] >= floor)) ++census.unexplained;
      census.worst = std::min(census.worst, angles[k] / floor);
    }
  }
  std::sort(least.begin(), least.end());
  const auto rank = std::lower_bound(least.begin(), least.end(), 15.0) - least.begin();
  census.below_15 = static_cast<double>(rank) / static_cast<double>(least.size());
  census.median = least[least.size() / 2];
  census.smallest = least.front();
  return census;
}

std::string AngleCensus::text() const {
  std::ostringstream out;
  out << "least angles: median " << median << ", smallest " << smallest << ", under 15 "
      << 100 * below_15 << " %; angles under 5: " << below_5_degrees << ", unexplained "
      << unexplained << ", worst " << worst << " of its floor; sharpest corner " << sharpest_corner;
  return out.str();
}

}  // namespace vdwmesh::testing
