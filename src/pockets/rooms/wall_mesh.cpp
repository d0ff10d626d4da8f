// WallMesh: divides triangles at points of their edges, and puts points onto spheres, onto the
// circles in which two of them meet, and where a plane meets either.
#include "pockets/rooms/wall_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "core/no_index.hpp"

namespace vdwmesh {
namespace {

// The circle in which two spheres meet.
struct WallCircle {
  Vec3d center, axis;  // axis: unit
  double radius;
};

std::optional<WallCircle> circle_of(const Sphere& a, const Sphere& b) {
  const Vec3d between = b.center - a.center;
  const double length = norm(between);
  const double foot = length / 2 + (a.radius - b.radius) * (a.radius + b.radius) / (2 * length);
  const double squared_radius = (a.radius - foot) * (a.radius + foot);
  if (!(squared_radius > 0)) return std::nullopt;
  const Vec3d axis = 1 / length * between;
  return WallCircle{a.center + foot * axis, axis, std::sqrt(squared_radius)};
}

// The point on the circle in the direction of p from its centre.
std::optional<Vec3d> onto_circle(const WallCircle& circle, const Vec3d& p) {
  const Vec3d d = p - circle.center;
  const Vec3d flat = d - dot(d, circle.axis) * circle.axis;
  const double length = norm(flat);
  if (!(length > 0)) return std::nullopt;
  return circle.center + circle.radius / length * flat;
}

// The nearer one of the points in which the circle meets the plane.
std::optional<Vec3d> onto_circle(const WallCircle& circle, const WallPlane& plane, const Vec3d& p) {
  const Vec3d slope = plane.normal - dot(plane.normal, circle.axis) * circle.axis;
  const double steepness = squared_norm(slope);
  if (!(steepness > 1e-20)) return std::nullopt;
  const Vec3d to_chord = -plane.height(circle.center) / steepness * slope;
  const double squared_half = circle.radius * circle.radius - squared_norm(to_chord);
  if (!(squared_half >= 0)) return std::nullopt;
  const Vec3d along = std::sqrt(squared_half / steepness) * cross(circle.axis, slope);
  const Vec3d foot = circle.center + to_chord;
  return foot + (dot(along, p - foot) > 0 ? 1.0 : -1.0) * along;
}

bool has_one_sphere(const VertexSpheres& label) { return label[1] == kNoSphere; }

}  // namespace

WallMesh::WallMesh(const SphereSet& spheres, const IndexedMesh& union_mesh)
    : positions(union_mesh.positions.begin(), union_mesh.positions.end()),
      is_fixed(positions.size(), 0),
      spheres_(spheres),
      of_sphere_(spheres.size()) {
  for (std::size_t v = 0; v < positions.size(); ++v) {
    labels.push_back(union_mesh.vertex_spheres[v]);
  }
  for (std::size_t t = 0; t < union_mesh.triangle_count(); ++t) {
    add_triangle(union_mesh.triangles[t], union_mesh.triangle_spheres[t]);
  }
}

std::uint32_t WallMesh::add_vertex(const Vec3d& position, const VertexSpheres& label) {
  positions.push_back(position), labels.push_back(label), is_fixed.push_back(0);
  return static_cast<std::uint32_t>(positions.size() - 1);
}

void WallMesh::add_triangle(const Triangle& triangle, SphereId sphere) {
  of_sphere_[sphere].push_back(static_cast<std::uint32_t>(triangles.size()));
  triangles.push_back(triangle), triangle_spheres.push_back(sphere);
}

void WallMesh::split(const std::vector<std::uint32_t>& among,
                     const std::unordered_map<EdgeKey, std::uint32_t>& points) {
  for (const std::uint32_t t : among) {
    std::array<std::uint32_t, 3> middles;  // of the edge from corner k to the next
    bool is_split = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto found = points.find(edge_key(triangles[t][k], triangles[t][(k + 1) % 3]));
      middles[k] = found == points.end() ? kNoIndex : found->second;
      is_split |= middles[k] != kNoIndex;
    }
    if (is_split) divide(t, middles);
  }
}

// Turns the triangle until its first edge is the one without a point, if one alone lacks it, or the
// one with a point, if one alone has it.
void WallMesh::divide(std::uint32_t triangle, const std::array<std::uint32_t, 3>& middles) {
  const SphereId s = triangle_spheres[triangle];
  const auto count = 3 - std::count(middles.begin(), middles.end(), kNoIndex);
  std::size_t first = 0;
  while (count < 3 && (middles[first] != kNoIndex) != (count == 1)) ++first;
  const Triangle whole = triangles[triangle];
  const auto corner = [&](std::size_t k) { return whole[(first + k) % 3]; };
  const std::uint32_t a = corner(0), b = corner(1), c = corner(2);
  const std::uint32_t ab = middles[first], bc = middles[(first + 1) % 3],
                      ca = middles[(first + 2) % 3];
  if (count == 1) {
    triangles[triangle] = {a, ab, c};
    add_triangle({ab, b, c}, s);
  } else if (count == 2) {
    triangles[triangle] = {ca, bc, c};
    const bool takes_a =
        squared_norm(positions[a] - positions[bc]) < squared_norm(positions[b] - positions[ca]);
    add_triangle(takes_a ? Triangle{a, b, bc} : Triangle{a, b, ca}, s);
    add_triangle(takes_a ? Triangle{a, bc, ca} : Triangle{b, bc, ca}, s);
  } else {
    triangles[triangle] = {ab, bc, ca};
    add_triangle({a, ab, ca}, s), add_triangle({ab, b, bc}, s), add_triangle({ca, bc, c}, s);
  }
}

void WallMesh::insert(std::uint32_t triangle, std::uint32_t vertex) {
  const auto [a, b, c] = triangles[triangle];
  triangles[triangle] = {a, b, vertex};
  add_triangle({b, c, vertex}, triangle_spheres[triangle]);
  add_triangle({c, a, vertex}, triangle_spheres[triangle]);
}

void WallMesh::divide_longer(std::vector<std::uint32_t>& list, double longest) {
  constexpr int kRounds = 24;
  for (int round = 0; round < kRounds; ++round) {
    std::unordered_map<EdgeKey, VertexSpheres> inner, seen;  // edges with two triangles, with any
    for (const std::uint32_t t : list) {
      const SphereId s = triangle_spheres[t];
      for (std::size_t k = 0; k < 3; ++k) {
        const EdgeKey edge = edge_key(triangles[t][k], triangles[t][(k + 1) % 3]);
        const auto [first, is_first] = seen.try_emplace(edge, on_sphere(s));
        const SphereId other = first->second[0];
        if (!is_first)
          inner[edge] = other == s
                            ? first->second
                            : VertexSpheres{std::min(s, other), std::max(s, other), kNoSphere};
      }
    }
    const auto length = [&](EdgeKey e) {
      return norm(positions[e >> 32] - positions[static_cast<std::uint32_t>(e)]);
    };
    std::unordered_map<EdgeKey, std::uint32_t> points;
    for (const std::uint32_t t : list) {
      std::pair<double, EdgeKey> best{longest, 0};
      for (std::size_t k = 0; k < 3; ++k) {
        const EdgeKey edge = edge_key(triangles[t][k], triangles[t][(k + 1) % 3]);
        if (inner.contains(edge)) best = std::max(best, {length(edge), edge});
      }
      const EdgeKey edge = best.second;
      if (edge == 0 || points.contains(edge)) continue;
      const Vec3d middle =
          0.5 * (positions[edge >> 32] + positions[static_cast<std::uint32_t>(edge)]);
      const VertexSpheres& label = inner.at(edge);
      if (const auto p = onto(label, middle)) points[edge] = add_vertex(*p, label);
    }
    if (points.empty()) return;
    const auto before = static_cast<std::uint32_t>(triangles.size());
    split(list, points);
    for (auto t = before; t < triangles.size(); ++t) list.push_back(t);
  }
}

std::optional<Vec3d> WallMesh::onto(const VertexSpheres& label, const Vec3d& p) const {
  const Sphere& s = spheres_[label[0]];
  if (!has_one_sphere(label)) {
    const auto circle = circle_of(s, spheres_[label[1]]);
    return circle ? onto_circle(*circle, p) : std::nullopt;
  }
  const Vec3d d = p - s.center;
  const double length = norm(d);
  return length > 0 ? std::optional(s.center + s.radius / length * d) : std::nullopt;
}

std::optional<Vec3d> WallMesh::onto(const VertexSpheres& label, const WallPlane& plane,
                                    const Vec3d& p) const {
  const Sphere& s = spheres_[label[0]];
  if (!has_one_sphere(label)) {
    const auto circle = circle_of(s, spheres_[label[1]]);
    return circle ? onto_circle(*circle, plane, p) : std::nullopt;
  }
  const double height = plane.height(s.center);
  const double squared_radius = (s.radius - height) * (s.radius + height);
  if (!(squared_radius > 0)) return std::nullopt;
  return onto_circle({s.center - height * plane.normal, plane.normal, std::sqrt(squared_radius)},
                     p);
}

}  // namespace vdwmesh
