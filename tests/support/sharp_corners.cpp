// bounded_angles(): walks around every corner of the mesh, patch by patch.
#include "support/sharp_corners.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>
#include <unordered_map>
#include <utility>
#include <vector>

#include "support/crease_survey.hpp"

namespace vdwmesh::testing {
namespace {

struct SharpCorner {
  Vec3d position;
  double reach;
};
using SharpCorners = std::unordered_map<SphereId, std::vector<SharpCorner>>;

// The triangles at one vertex: by the vertex that comes first, counter-clockwise.
struct Star {
  struct Wedge {
    std::uint32_t next;
    SphereId sphere;
  };
  std::map<std::uint32_t, Wedge> wedges;
};

// Where the patch on the left of the edge from `corner` to `first` begins, behind sphere `right`.
void walk_patch(const SphereSet& spheres, const IndexedMesh& mesh, std::uint32_t corner,
                const Star& star, std::uint32_t first, SphereId right, SharpCorners& sharp) {
  const SphereId own = star.wedges.at(first).sphere;
  std::uint32_t last = first;
  auto at = star.wedges.find(first);
  while (at != star.wedges.end() && at->second.sphere == own) {
    last = at->second.next;
    at = star.wedges.find(last);
  }
  if (at == star.wedges.end()) return;  // several fans in one point
  const Vec3d &p = mesh.positions[corner], &a = mesh.positions[first], &b = mesh.positions[last];
  const double angle =
      patch_corner_angle(spheres[own], p, spheres[right], a, spheres[at->second.sphere], b);
  // An angle of nothing may come out as a whole turn.
  if (angle >= 60 && angle < 359) return;
  sharp[own].push_back({p, 2 * (1 + 1e-5) * std::max(norm(a - p), norm(b - p))});
}

SharpCorners find_sharp_corners(const SphereSet& spheres, const IndexedMesh& mesh) {
  std::unordered_map<std::uint32_t, Star> stars;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& v = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      if (mesh.vertex_spheres[v[k]][2] == kNoSphere) continue;
      stars[v[k]].wedges[v[(k + 1) % 3]] = {v[(k + 2) % 3], mesh.triangle_spheres[t]};
    }
  }
  SharpCorners sharp;
  for (const auto& [corner, star] : stars) {
    for (const auto& [first, wedge] : star.wedges) {
      const auto next = star.wedges.find(wedge.next);
      if (next == star.wedges.end() || next->second.sphere == wedge.sphere) continue;
      walk_patch(spheres, mesh, corner, star, wedge.next, wedge.sphere, sharp);
    }
  }
  return sharp;
}

double least_angle(const std::array<Vec3d, 3>& p) {
  double least = 180;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d a = p[(k + 1) % 3] - p[k], b = p[(k + 2) % 3] - p[k];
    least = std::min(least, std::atan2(norm(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi);
  }
  return least;
}

}  // namespace

BoundedAngles bounded_angles(const SphereSet& spheres, const IndexedMesh& mesh, double degrees) {
  BoundedAngles found;
  SharpCorners sharp = find_sharp_corners(spheres, mesh);
  for (const auto& [sphere, corners] : sharp) found.sharp_corners += corners.size();
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& v = mesh.triangles[t];
    const std::array<Vec3d, 3> p{mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]};
    const double angle = least_angle(p);
    if (angle >= degrees && angle >= found.smallest) continue;
    const auto corners = sharp.find(mesh.triangle_spheres[t]);
    const bool is_excused =
        corners != sharp.end() && std::ranges::any_of(corners->second, [&](const SharpCorner& c) {
          return std::ranges::all_of(
              p, [&](const Vec3d& vertex) { return norm(vertex - c.position) <= c.reach; });
        });
    if (is_excused) {
      found.below_excused += angle < degrees;
    } else {
      found.below += angle < degrees;
      found.smallest = std::min(found.smallest, angle);
    }
  }
  return found;
}

std::string BoundedAngles::text() const {
  std::ostringstream out;
  out << "smallest angle " << smallest << ", triangles below the bound " << below << ", excused "
      << below_excused << ", sharp corners " << sharp_corners;
  return out.str();
}

}  // namespace vdwmesh::testing
