#include "support/curved_measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace vdwmesh::testing {
namespace {

// Of the triangle that three unit vectors span (van Oosterom and Strackee 1983), by differences,
// which keep the digits of small triangles.
double solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return 2 * std::atan2(dot(a, cross(b - a, c - a)), 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

struct Lens {
  double solid_angle;  // between circle and great circle, positive where the great circle is nearer
                       // to the cap's axis
  double segment;      // Å²: between the circle and the chord, in the circle's plane
  double height;       // Å: of that plane over the sphere's centre, towards the other sphere
};

// Of the circle that sphere s shares with `other`, between points p and q of it less than half a
// turn apart.
Lens lens_between(const Sphere& s, const Sphere& other, const Vec3d& p, const Vec3d& q) {
  const Vec3d between = other.center - s.center;
  const double distance = norm(between);
  const Vec3d to_other = (1 / distance) * between;
  const double height =
      (distance + (s.radius - other.radius) * (s.radius + other.radius) / distance) / 2;
  // A cap wider than half the sphere is judged by what it leaves.
  const double side = height < 0 ? -1 : 1;
  const Vec3d axis = side * to_other, u = p - s.center, v = q - s.center;
  const Vec3d radial_u = u - dot(u, axis) * axis, radial_v = v - dot(v, axis) * axis;
  const double turn = std::atan2(norm(cross(radial_u, radial_v)), dot(radial_u, radial_v));
  const double sector = (1 - std::abs(height) / s.radius) * turn;
  const double inner = std::abs(solid_angle(axis, (1 / norm(u)) * u, (1 / norm(v)) * v));
  const double squared_circle = norm(radial_u) * norm(radial_v);
  return {side * (sector - inner), squared_circle * (turn - std::sin(turn)) / 2, height};
}

struct HalfEdge {
  std::uint32_t low, high;
  SphereId sphere;
};

std::vector<HalfEdge> sorted_half_edges(const IndexedMesh& mesh) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.triangle_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
      edges.push_back({low, high, mesh.triangle_spheres[t]});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::pair(a.low, a.high) < std::pair(b.low, b.high);
  });
  return edges;
}

void add_triangles(const SphereSet& spheres, const IndexedMesh& mesh, CurvedMeasures& out) {
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Sphere& s = spheres[mesh.triangle_spheres[t]];
    std::array<Vec3d, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.positions[mesh.triangles[t][k]] - s.center;
    const auto unit = [](const Vec3d& v) { return (1 / norm(v)) * v; };
    const double angle = solid_angle(unit(p[0]), unit(p[1]), unit(p[2]));
    out.area[mesh.triangle_spheres[t]] += s.radius * s.radius * angle;
    out.volume +=
        s.radius * s.radius * s.radius * angle / 3 - dot(p[0], cross(p[1] - p[0], p[2] - p[0])) / 6;
  }
}

void take_lenses(const SphereSet& spheres, const IndexedMesh& mesh, CurvedMeasures& out) {
  const std::vector<HalfEdge> edges = sorted_half_edges(mesh);
  for (std::size_t i = 0; i + 1 < edges.size(); i += 2) {
    const SphereId one = edges[i].sphere, two = edges[i + 1].sphere;
    if (one == two) continue;
    const Vec3d &p = mesh.positions[edges[i].low], &q = mesh.positions[edges[i].high];
    for (const auto& [id, other] : {std::pair(one, two), std::pair(two, one)}) {
      const Sphere& s = spheres[id];
      const Lens lens = lens_between(s, spheres[other], p, q);
      out.area[id] -= s.radius * s.radius * lens.solid_angle;
      out.volume +=
          (lens.height * lens.segment - s.radius * s.radius * s.radius * lens.solid_angle) / 3;
    }
  }
}

}  // namespace

CurvedMeasures curved_measures(const SphereSet& spheres, const IndexedMesh& mesh,
                               double flat_volume) {
  CurvedMeasures out{std::vector<double>(spheres.size(), 0.0), flat_volume};
  add_triangles(spheres, mesh, out);
  take_lenses(spheres, mesh, out);
  return out;
}

}  // namespace vdwmesh::testing
