// Meshes of unions of balls whose edges follow the creases, built from mathematics: every vertex on
// its spheres, every triangle of one sphere.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::testing {

struct CreaseMesh {
  SphereSet spheres;
  IndexedMesh mesh;
};

// Lower ids first.
inline VertexSpheres on_spheres(std::vector<SphereId> ids) {
  std::sort(ids.begin(), ids.end());
  ids.resize(3, kNoSphere);
  return {ids[0], ids[1], ids[2]};
}

inline std::uint32_t add_vertex(IndexedMesh& mesh, const Vec3d& p, const VertexSpheres& label) {
  mesh.positions.push_back(p);
  mesh.vertex_spheres.push_back(label);
  return static_cast<std::uint32_t>(mesh.vertex_count() - 1);
}

inline void add_triangle(IndexedMesh& mesh, const Triangle& t, SphereId sphere) {
  mesh.triangles.push_back(t);
  mesh.triangle_spheres.push_back(sphere);
}

inline Vec3d unit_along(const Vec3d& v) { return (1 / norm(v)) * v; }

inline Vec3d any_normal_to(const Vec3d& v) {
  const Vec3d other = std::abs(v.x) < std::abs(v.z) ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1};
  return unit_along(cross(v, other));
}

// The sphere's cap between its pole (direction `pole`) and the ring of vertices that bounds it,
// which runs counter-clockwise about the pole: rings of as many vertices, shrinking by equal
// angles.
inline void add_cap(IndexedMesh& mesh, const Sphere& s, SphereId id, const Vec3d& pole,
                    std::vector<std::uint32_t> ring, int rings) {
  const auto n = ring.size();
  std::vector<Vec3d> radial(n);
  double widest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d out = mesh.positions[ring[i]] - s.center;
    const double height = dot(out, pole);
    const Vec3d across = out - height * pole;
    radial[i] = unit_along(across);
    widest = std::atan2(norm(across), height);
  }
  for (int r = rings - 1; r >= 1; --r) {
    const double angle = widest * r / rings;
    std::vector<std::uint32_t> inner(n);
    for (std::size_t i = 0; i < n; ++i) {
      inner[i] = add_vertex(
          mesh,
          s.center + s.radius * (std::cos(angle) * pole) + s.radius * (std::sin(angle) * radial[i]),
          on_sphere(id));
    }
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t next = (i + 1) % n;
      add_triangle(mesh, {ring[i], ring[next], inner[next]}, id);
      add_triangle(mesh, {ring[i], inner[next], inner[i]}, id);
    }
    ring = inner;
  }
  const std::uint32_t top = add_vertex(mesh, s.center + s.radius * pole, on_sphere(id));
  for (std::size_t i = 0; i < n; ++i) add_triangle(mesh, {ring[i], ring[(i + 1) % n], top}, id);
}

// n vertices on the circle of spheres 0 and 1, counter-clockwise about the axis from 0 to 1. Its
// radius by Heron's formula, which loses nothing where the balls nearly touch.
inline std::vector<std::uint32_t> add_circle(CreaseMesh& m, int n) {
  const Sphere &a = m.spheres[0], &b = m.spheres[1];
  const Vec3d between = b.center - a.center, axis = unit_along(between);
  const double d = norm(between), r = a.radius, s = b.radius;
  const double height = (d * d + (r - s) * (r + s)) / (2 * d);
  const double radius = std::sqrt((r + s - d) * (r + s + d) * (d - r + s) * (d + r - s)) / (2 * d);
  const Vec3d u = any_normal_to(axis), v = cross(axis, u);
  std::vector<std::uint32_t> ring;
  for (int i = 0; i < n; ++i) {
    const double t = 2 * std::numbers::pi * i / n;
    ring.push_back(add_vertex(
        m.mesh, a.center + height * axis + (radius * std::cos(t)) * u + (radius * std::sin(t)) * v,
        {0, 1, kNoSphere}));
  }
  return ring;
}

// The union of two balls that overlap properly.
inline CreaseMesh two_balls_mesh(const Sphere& a, const Sphere& b, int n, int rings) {
  CreaseMesh m{SphereSet({a, b}), {}};
  const Vec3d axis = unit_along(b.center - a.center);
  std::vector<std::uint32_t> ring = add_circle(m, n);
  add_cap(m.mesh, b, 1, axis, ring, rings);
  std::reverse(ring.begin(), ring.end());
  add_cap(m.mesh, a, 0, -1.0 * axis, ring, rings);
  return m;
}

// The same with b's cap cut into triangles without another vertex: n - 3 of its edges have both
// ends on the circle, and run through b's patch.
inline CreaseMesh bump_without_inner_vertices(const Sphere& a, const Sphere& b, int n, int rings) {
  CreaseMesh m{SphereSet({a, b}), {}};
  std::vector<std::uint32_t> ring = add_circle(m, n);
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    add_triangle(m.mesh, {ring[0], ring[i], ring[i + 1]}, 1);
  }
  std::reverse(ring.begin(), ring.end());
  add_cap(m.mesh, a, 0, unit_along(a.center - b.center), ring, rings);
  return m;
}

// The union of three balls that have two points of their spheres in common, the corners: vertices 0
// and 1. The planes through the line of the corners cut each patch in arcs from corner to corner:
// `columns` bands of them, each arc in `segments` pieces.
class ThreeBallsMesh {
 public:
  ThreeBallsMesh(const std::array<Sphere, 3>& balls, int columns, int segments)
      : balls_(balls), columns_(columns), segments_(segments) {
    set_frame();
    add_vertex(mesh_, foot_ + half_chord_ * up_, on_spheres({0, 1, 2}));
    add_vertex(mesh_, foot_ - half_chord_ * up_, on_spheres({0, 1, 2}));
    std::array<std::vector<std::uint32_t>, 3> arcs;
    for (SphereId i = 0; i < 3; ++i) {
      arcs[i] = add_arc(i, start_of_sector(i), on_spheres({(i + 2) % 3, i}));
    }
    for (SphereId i = 0; i < 3; ++i) add_patch(i, arcs[i], arcs[(i + 1) % 3]);
  }
  CreaseMesh take() { return {SphereSet({balls_[0], balls_[1], balls_[2]}), std::move(mesh_)}; }

 private:
  // The corners stand over and under the point of equal power in the plane of the centres.
  void set_frame() {
    const Vec3d &o = balls_[0].center, u = balls_[1].center - o, v = balls_[2].center - o;
    up_ = unit_along(cross(u, v));
    const double r = balls_[0].radius, s = balls_[1].radius, t = balls_[2].radius;
    const double wu = (dot(u, u) + r * r - s * s) / 2, wv = (dot(v, v) + r * r - t * t) / 2;
    const double gram = dot(u, u) * dot(v, v) - dot(u, v) * dot(u, v);
    const Vec3d across = ((wu * dot(v, v) - wv * dot(u, v)) / gram) * u +
                         ((wv * dot(u, u) - wu * dot(u, v)) / gram) * v;
    foot_ = o + across;
    half_chord_ = std::sqrt(r * r - dot(across, across));
    east_ = unit_along(u);
    north_ = cross(up_, east_);
  }

  // The angle of the ray where the powers of balls i - 1 and i are equal and least: away from the
  // third. Counter-clockwise from it follows the sector of ball i.
  double start_of_sector(SphereId i) const {
    const Vec3d& third = balls_[(i + 1) % 3].center;
    const Vec3d between = balls_[i].center - balls_[(i + 2) % 3].center;
    Vec3d ray = cross(up_, between);
    if (dot(ray, third - balls_[i].center) > 0) ray = -1.0 * ray;
    return std::atan2(dot(ray, north_), dot(ray, east_));
  }

  // The inner vertices of the arc of sphere i, from the upper corner to the lower one.
  std::vector<std::uint32_t> add_arc(SphereId i, double angle, const VertexSpheres& label) {
    const Vec3d ray = std::cos(angle) * east_ + std::sin(angle) * north_;
    const double middle = dot(balls_[i].center - foot_, ray);
    const double radius = std::hypot(middle, half_chord_);
    const double end = std::atan2(half_chord_, -middle);
    std::vector<std::uint32_t> arc;
    for (int s = 1; s < segments_; ++s) {
      const double t = end * (1 - 2.0 * s / segments_);
      arc.push_back(add_vertex(
          mesh_, foot_ + (middle + radius * std::cos(t)) * ray + (radius * std::sin(t)) * up_,
          label));
    }
    return arc;
  }

  void add_patch(SphereId i, std::vector<std::uint32_t> left,
                 const std::vector<std::uint32_t>& last) {
    const double from = start_of_sector(i);
    double to = start_of_sector((i + 1) % 3);
    if (to < from) to += 2 * std::numbers::pi;
    for (int c = 1; c <= columns_; ++c) {
      const double angle = from + (to - from) * c / columns_;
      const std::vector<std::uint32_t> right =
          c == columns_ ? last : add_arc(i, angle, on_sphere(i));
      add_triangle(mesh_, {left.front(), right.front(), 0}, i);
      for (std::size_t s = 0; s + 1 < left.size(); ++s) {
        add_triangle(mesh_, {left[s + 1], right[s + 1], right[s]}, i);
        add_triangle(mesh_, {left[s + 1], right[s], left[s]}, i);
      }
      add_triangle(mesh_, {left.back(), 1, right.back()}, i);
      left = right;
    }
  }

  std::array<Sphere, 3> balls_;
  int columns_, segments_;
  IndexedMesh mesh_;
  Vec3d up_{}, east_{}, north_{}, foot_{};
  double half_chord_ = 0;
};

inline CreaseMesh three_balls_mesh(const std::array<Sphere, 3>& balls, int columns, int segments) {
  return ThreeBallsMesh(balls, columns, segments).take();
}

// The same mesh with sphere i of the set at place[i].
inline CreaseMesh relabelled(const CreaseMesh& m, const std::vector<SphereId>& place) {
  std::vector<Sphere> spheres(m.spheres.size());
  for (std::size_t i = 0; i < spheres.size(); ++i) spheres[place[i]] = m.spheres[i];
  CreaseMesh result{SphereSet(spheres), m.mesh};
  for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
    VertexSpheres label = result.mesh.vertex_spheres[v];
    for (SphereId& id : label) id = id == kNoSphere ? id : place[id];
    std::sort(label.begin(), label.end());  // kNoSphere is the largest
    result.mesh.vertex_spheres.set(v, label);
  }
  for (SphereId& id : result.mesh.triangle_spheres) id = place[id];
  return result;
}

}  // namespace vdwmesh::testing
