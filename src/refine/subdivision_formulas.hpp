// Midpoint subdivision of one triangle, its labels, normals and orientation, for host and device.
//
// Triangle t with corners v0 v1 v2 and midpoints m_k on its half-edges 3t + k becomes
// 4t + k = (v_k, m_k, m_(k+2)) for k = 0, 1, 2 and 4t + 3 = (m0, m1, m2).
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "refine/sphere_formulas.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

VDWMESH_HD constexpr int previous_corner(int k) { return k == 0 ? 2 : k - 1; }

// Corners of the four triangles, in terms of those of the parent: 0, 1, 2 its corners, 3, 4, 5 its
// midpoints.
VDWMESH_HD constexpr int child_corner(int child, int k) {
  if (child == 3) return 3 + k;
  return k == 0 ? child : (k == 1 ? 3 + child : 3 + previous_corner(child));
}

// Half-edge h = 3t + k is halved: the first half leaves its start, the second reaches its end.
VDWMESH_HD constexpr std::uint32_t first_half(std::uint32_t h) {
  const std::uint32_t t = h / 3, k = h % 3;
  return 3 * (4 * t + k);
}
VDWMESH_HD constexpr std::uint32_t second_half(std::uint32_t h) {
  const std::uint32_t t = h / 3, k = h % 3;
  return 3 * (4 * t + (k == 2 ? 0 : k + 1)) + 2;
}

// Writes the opposites of half-edge h's two halves and of the pair of half-edges that cut the
// corner at its start. `own` are the twelve entries of the children of h's triangle; over its three
// half-edges each is written once.
VDWMESH_HD inline void write_child_opposites(std::uint32_t h, std::uint32_t opposite_of_h,
                                             std::uint32_t* own) {
  const std::uint32_t k = h % 3, base = 12 * (h / 3);
  own[first_half(k)] = second_half(opposite_of_h);
  own[second_half(k)] = first_half(opposite_of_h);
  const std::uint32_t outer = 3 * k + 1;                   // m_k -> m_(k+2)
  const std::uint32_t inner = 9 + (k == 0 ? 2u : k - 1u);  // m_(k+2) -> m_k
  own[outer] = base + inner;
  own[inner] = base + outer;
}

// The same bits from either end.
VDWMESH_HD inline Vec3d midpoint(const Vec3d& a, const Vec3d& b) { return 0.5 * (a + b); }

// Which of two spheres (either may be kNoSphere) is nearer to p by d - r; ties: canonical order.
VDWMESH_HD inline SphereId nearer_sphere(const Sphere* spheres, SphereId a, SphereId b,
                                         const Vec3d& p) {
  if (a == b || b == kNoSphere) return a;
  if (a == kNoSphere) return b;
  const double gap_a = gap(spheres[a], p), gap_b = gap(spheres[b], p);
  if (gap_a != gap_b) return gap_a < gap_b ? a : b;
  if (precedes(spheres[a], spheres[b])) return a;
  if (precedes(spheres[b], spheres[a])) return b;
  return a < b ? a : b;
}

// A unit vector, or +z for a vector without direction: a normal must be something.
VDWMESH_HD inline Vec3f unit_normal(const Vec3d& v) {
  const double length = norm(v);
  if (!(length > 0)) return {0, 0, 1};
  const double scale = 1 / length;
  return cast<float>(scale * v);
}

// Unit vector from the sphere's centre to p; zero at the centre.
VDWMESH_HD inline Vec3d outward(const Sphere& s, const Vec3d& p) {
  const Vec3d out = p - s.center;
  const double length = norm(out);
  const double scale = length > 0 ? 1 / length : 0.0;
  return scale * out;
}

// Outward normal of a sphere at a point of it.
VDWMESH_HD inline Vec3f sphere_normal(const Sphere& s, const Vec3d& p) {
  return unit_normal(p - s.center);
}

// Normal of the union's boundary at a vertex: that of its sphere; on a circle or corner the mean of
// the outward normals of the spheres that meet there, each once: the middle of the directions that
// the crease spans, whatever triangles lie around it. Opposite normals (balls in point contact)
// leave the first sphere's.
VDWMESH_HD inline Vec3f union_normal(const Sphere* spheres, const SphereId* label, const Vec3d& p) {
  if (label[0] != kNoSphere && label[1] == kNoSphere) {
    return sphere_normal(spheres[label[0]], p);
  }
  Vec3d sum{0, 0, 0};
  for (int i = 0; i < 3 && label[i] != kNoSphere; ++i) sum = sum + outward(spheres[label[i]], p);
  if (!(squared_norm(sum) > 1e-12) && label[0] != kNoSphere) sum = outward(spheres[label[0]], p);
  return unit_normal(sum);
}

// How a triangle stands to the outward normals of its atoms.
enum class Facing : std::uint8_t { outward, against_one_atom, against_several_atoms };

// A triangle of one atom is measured against the atom's normal at its centroid, one of several
// against the mean of their normals at its corners, outward_at(k). Without atoms it faces outward.
template <class OutwardAt>
VDWMESH_HD inline Facing facing(const Sphere* spheres, const Vec3d* p, const SphereId* atom,
                                const OutwardAt& outward_at) {
  if (atom[0] == kNoSphere || atom[1] == kNoSphere || atom[2] == kNoSphere) return Facing::outward;
  const Vec3d area = cross(p[1] - p[0], p[2] - p[0]);
  if (atom[0] == atom[1] && atom[0] == atom[2]) {
    const Vec3d& c = spheres[atom[0]].center;
    const Vec3d out = ((p[0] - c) + (p[1] - c)) + (p[2] - c);
    return dot(area, out) < 0 ? Facing::against_one_atom : Facing::outward;
  }
  const Vec3d out = (outward_at(0) + outward_at(1)) + outward_at(2);
  return dot(area, out) < 0 ? Facing::against_several_atoms : Facing::outward;
}
VDWMESH_HD inline Facing facing(const Sphere* spheres, const Vec3d* p, const SphereId* atom) {
  return facing(spheres, p, atom, [=](int k) { return outward(spheres[atom[k]], p[k]); });
}

}  // namespace vdwmesh
