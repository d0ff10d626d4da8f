// Midpoint subdivision of one triangle: indices, labels, normals, orientation. For host and device.
//
// Triangle t has the corners v0, v1, v2. Its half-edge 3t + k runs from v_k to v_(k+1), and
// midpoint m_k halves it. The children of t are the triangles 4t + k = (v_k, m_k, m_(k+2)) for k =
// 0, 1, 2, one at each corner, and the middle triangle 4t + 3 = (m0, m1, m2). Indices of corners
// and midpoints are modulo 3. The half-edge opposite to h is the one that runs back along the same
// edge.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "refine/sphere_formulas.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

VDWMESH_HD constexpr int previous_corner(int k) { return k == 0 ? 2 : k - 1; }

// Corner k of child `child`, as an index into a patch of six vertices: 0, 1, 2 are the corners of
// the parent, 3, 4, 5 its midpoints m0, m1, m2.
VDWMESH_HD constexpr int child_corner(int child, int k) {
  if (child == 3) return 3 + k;
  return k == 0 ? child : (k == 1 ? 3 + child : 3 + previous_corner(child));
}

// The half-edges of the children into which the parent's half-edge h = 3t + k is split: the first
// half runs from v_k to m_k and belongs to child k, the second from m_k to v_(k+1) in child k + 1.
VDWMESH_HD constexpr std::uint32_t first_half(std::uint32_t h) {
  const std::uint32_t t = h / 3, k = h % 3;
  return 3 * (4 * t + k);
}
VDWMESH_HD constexpr std::uint32_t second_half(std::uint32_t h) {
  const std::uint32_t t = h / 3, k = h % 3;
  return 3 * (4 * t + (k == 2 ? 0 : k + 1)) + 2;
}

// The four children of a triangle have twelve half-edges. This writes the opposites of four of
// them: of the two halves of the triangle's half-edge h = 3t + k, and of the two half-edges between
// child k and the middle child. Three calls, one for each half-edge of the triangle, write each of
// the twelve entries once. `own` points to the first of them; the values are half-edges of the
// finer mesh.
VDWMESH_HD inline void write_child_opposites(std::uint32_t h, std::uint32_t opposite_of_h,
                                             std::uint32_t* own) {
  const std::uint32_t k = h % 3, base = 12 * (h / 3);
  own[first_half(k)] = second_half(opposite_of_h);
  own[second_half(k)] = first_half(opposite_of_h);
  // Counted from the first half-edge of the four children, `base`.
  const std::uint32_t outer = 3 * k + 1;                   // of child k: m_k -> m_(k+2)
  const std::uint32_t inner = 9 + (k == 0 ? 2u : k - 1u);  // of the middle child: m_(k+2) -> m_k
  own[outer] = base + inner;
  own[inner] = base + outer;
}

// The middle of the edge from a to b. Addition commutes, so b and a give the same bits.
VDWMESH_HD inline Vec3d midpoint(const Vec3d& a, const Vec3d& b) { return 0.5 * (a + b); }

// Of the spheres a and b, the sphere from which p has the lesser signed distance gap(). If one of
// them is kNoSphere, the other is returned. Ties go to the first in canonical order, and between
// equal spheres to the lower id.
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

// v divided by its length. The zero vector gives +z, so that every normal has unit length.
VDWMESH_HD inline Vec3f unit_normal(const Vec3d& v) {
  const double length = norm(v);
  if (!(length > 0)) return {0, 0, 1};
  const double scale = 1 / length;
  return cast<float>(scale * v);
}

// The unit normal in the middle between two normals.
VDWMESH_HD inline Vec3f mean_normal(const Vec3f& a, const Vec3f& b) {
  return unit_normal(cast<double>(a) + cast<double>(b));
}

// The unit vector from the sphere's centre to p; the zero vector if p is the centre.
VDWMESH_HD inline Vec3d outward(const Sphere& s, const Vec3d& p) {
  const Vec3d out = p - s.center;
  const double length = norm(out);
  const double scale = length > 0 ? 1 / length : 0.0;
  return scale * out;
}

// The outward unit normal of a sphere at its point p.
VDWMESH_HD inline Vec3f sphere_normal(const Sphere& s, const Vec3d& p) {
  return unit_normal(p - s.center);
}

// The unit normal of the union's boundary at vertex p with the given label. On one sphere it is the
// normal of that sphere. On a circle or corner, where the boundary has a crease, it has the
// direction of the sum of the normals of the spheres that meet there. It depends on the label
// alone, not on the triangles around p. If the normals cancel, which happens if two balls touch in
// one point, it is the normal of the first sphere.
VDWMESH_HD inline Vec3f union_normal(const Sphere* spheres, const SphereId* label, const Vec3d& p) {
  if (label[0] != kNoSphere && label[1] == kNoSphere) {
    return sphere_normal(spheres[label[0]], p);
  }
  Vec3d sum{0, 0, 0};
  for (int i = 0; i < 3 && label[i] != kNoSphere; ++i) sum = sum + outward(spheres[label[i]], p);
  // Unit vectors have rounding errors of about 1e-16. A sum longer than sqrt(1e-12) = 1e-6 has a
  // direction that is right to about 1e-10. A shorter sum counts as zero.
  if (!(squared_norm(sum) > 1e-12) && label[0] != kNoSphere) sum = outward(spheres[label[0]], p);
  return unit_normal(sum);
}

// Whether a triangle faces the way its atoms' outward normals point. If it does not, the other two
// values say whether its corners have one atom or several.
enum class Facing : std::uint8_t { outward, against_one_atom, against_several_atoms };

// Compares the normal of triangle p[0..2], in the sense of its winding, with an outward direction;
// the triangle faces outward unless their dot product is negative. `atom` has the atoms of the
// corners. If they are one atom, the outward direction is the vector from its centre to the
// centroid of the triangle, here times three. If they differ, it is the sum of the unit normals
// outward_at(k) at the corners k. A triangle with a corner without an atom counts as facing
// outward.
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
// The same, with outward_at(k) computed from the atom and position of corner k.
VDWMESH_HD inline Facing facing(const Sphere* spheres, const Vec3d* p, const SphereId* atom) {
  return facing(spheres, p, atom, [=](int k) { return outward(spheres[atom[k]], p[k]); });
}

}  // namespace vdwmesh
