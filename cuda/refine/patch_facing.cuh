// Orientation of the four children of a parent triangle: which of them face inward; which of these
// faced outward before the moves, so that the moves are bad; and which face outward so clearly that
// later levels need not test their descendants (safe, see PatchMarks).
#pragma once

#include "cuda/refine/refine_levels.cuh"

namespace vdwmesh {

// A parent triangle with its midpoints: three corners, then three midpoints.
struct ParentPatch {
  std::uint32_t vertex[6];
  Vec3d position[6];  // after the moves
  SphereId
      atom[6];  // the label of the parent triangle if triangles are labelled, else of the vertex
};

__device__ inline void load_vertices(const MidpointLevel& level, std::uint64_t t,
                                     ParentPatch& patch) {
  for (int i = 0; i < 6; ++i) patch.vertex[i] = level.vertex(t, i);
}

// Reads positions and atoms. Precondition: load_vertices() has been called.
__device__ inline void load_places(const MidpointLevel& level, std::uint64_t t,
                                   ParentPatch& patch) {
  const SphereId* triangle = level.parent.triangle_spheres;
  for (int i = 0; i < 6; ++i) {
    patch.position[i] = level.mesh.positions[patch.vertex[i]];
    patch.atom[i] =
        triangle != nullptr ? triangle[t] : level.mesh.vertex_spheres.atoms[patch.vertex[i]];
  }
}

// Whether a triangle is safe: its corners p have one atom, and it faces outward so clearly that its
// descendants with regular midpoints do so too, in spite of rounding, down to the last level. It
// may be false for a triangle that deserved true.
//
// The test is about the determinant of a = p1 - p0, b = p2 - p0 and `out`, three times the vector
// from the sphere's centre to the centroid. dot(cross(a, b), out) is 18 times the signed volume of
// the tetrahedron from the sphere's centre to the triangle, positive if it faces outward. A safe
// triangle has at least 1e-3 r e^2, with r the radius and e the longest edge. From a triangle to
// its children at least a quarter of the determinant remains, while e falls to about a half.
// Rounding the coordinates, of size C, changes the determinant by at most about 20 * 2^-53 C e r.
// After n levels the determinant is therefore at least 2^-n * 1e-3 e / (20 * 2^-53 C) times this
// error. With e >= 1e-6 C (the second condition) and n = 16, the largest number of subdivisions,
// the ratio is still above 6.
__device__ inline bool is_safe(const Sphere* spheres, const Vec3d* p, const SphereId* atom) {
  if (atom[0] == kNoSphere || atom[0] != atom[1] || atom[0] != atom[2]) return false;
  constexpr double least_volume = 1e-3, least_edge = 1e-6;
  const Sphere& s = spheres[atom[0]];
  const Vec3d a = p[1] - p[0], b = p[2] - p[0];
  const Vec3d out = ((p[0] - s.center) + (p[1] - s.center)) + (p[2] - s.center);
  const double edge_square = fmax(squared_norm(a), fmax(squared_norm(b), squared_norm(b - a)));
  const double far = fmax(squared_norm(p[0]), squared_norm(s.center)) + s.radius * s.radius;
  return dot(cross(a, b), out) >= least_volume * s.radius * edge_square &&
         edge_square >= least_edge * least_edge * far;
}

// Three sets of children, with bit k for child k. `turned` has the children that do not face
// outward, against_one_atom the turned children whose corners have one atom, `safe` the safe
// children.
struct ChildrenFacing {
  unsigned turned, against_one_atom, safe;
};

__device__ inline ChildrenFacing facing_of_children(const Sphere* spheres,
                                                    const ParentPatch& patch) {
  // The unit normals at the six vertices are needed only if atoms differ. They are computed once
  // here, because up to three children share a vertex.
  bool mixed = false;
  for (int i = 1; i < 6; ++i) mixed |= patch.atom[i] != patch.atom[0];
  Vec3d out[6];
  if (mixed) {
    for (int i = 0; i < 6; ++i) {
      if (patch.atom[i] != kNoSphere) out[i] = outward(spheres[patch.atom[i]], patch.position[i]);
    }
  }
  ChildrenFacing result{0, 0, 0};
  for (int child = 0; child < 4; ++child) {
    Vec3d p[3];
    SphereId atom[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = patch.position[child_corner(child, k)];
      atom[k] = patch.atom[child_corner(child, k)];
    }
    const Facing f = facing(spheres, p, atom, [&](int k) { return out[child_corner(child, k)]; });
    result.turned |= f != Facing::outward ? 1u << child : 0u;
    result.against_one_atom |= f == Facing::against_one_atom ? 1u << child : 0u;
    result.safe |= is_safe(spheres, p, atom) ? 1u << child : 0u;
  }
  return result;
}

// Marks the moved vertices of the bad children of parent triangle t: of those in the set `against`,
// ChildrenFacing::against_one_atom, that faced outward before the moves.
__device__ inline void mark_turned_children(const SurfaceView& surface, const MidpointLevel& level,
                                            std::uint64_t t, const ParentPatch& patch,
                                            unsigned against, const MoveStatesView& move_states) {
  for (int child = 0; child < 4; ++child) {
    if ((against >> child & 1) == 0) continue;
    Vec3d before[3];
    SphereId atom[3];
    for (int k = 0; k < 3; ++k) {
      before[k] = level.before(t, child_corner(child, k));
      atom[k] = patch.atom[child_corner(child, k)];
    }
    if (facing(surface.spheres, before, atom) != Facing::outward) continue;
    for (int k = 0; k < 3; ++k) move_states.mark(patch.vertex[child_corner(child, k)]);
  }
}

}  // namespace vdwmesh
