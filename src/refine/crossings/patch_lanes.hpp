// Up to kLanes triangles of a mesh that lie together (a patch) side by side, for tests of one
// triangle against all of them at once.
//
// Arrays are by axis and lane, lane t for triangle t of the patch (core/lanes/lanes.hpp). A test
// may leave out a pair of triangles only if triangles_cross() in crossing_formulas.hpp finds no
// crossing either. Left out are pairs that share an edge, pairs of one atom that share a vertex,
// and pairs in which neither triangle has corners strictly on both sides of the other's plane.
//
// Why rounding loses no pair: let n be the normal of a triangle's plane and w the vector from a
// corner of that triangle to the corner tested. triangles_cross() takes this corner to be on a side
// of the plane only if |n · w| exceeds 16 ε M, where M is at least S = Σ |n_i w_i| and ε = 2^-53.
// It adds with fused multiply-adds; here the same n and w are multiplied and added one by one.
// Either sum is within 3 ε S (1 + 3 ε) of the exact one, so the two differ by less than 7 ε S, and
// a side that counts there exceeds 9 ε S here, with the same sign. Here a side counts from 4 ε S
// on, and from kUnderflow, which is far above what products lose that underflow (3 · 2^-1074) and
// far below any side of a mesh in Å.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "core/lanes/lane_masks.hpp"
#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// A triangle of a mesh. `atom` is the atom that all its vertices have in common, or kNoSphere.
struct PatchTriangle {
  std::array<std::uint32_t, 3> vertex;
  std::array<Vec3d, 3> corner;
  SphereId atom;
};

class PatchLanes {
 public:
  // Takes triangle `lane` of the patch.
  void set(std::size_t lane, const PatchTriangle& t) {
    for (std::size_t k = 0; k < 3; ++k) {
      vertex_[k][lane] = t.vertex[k];
      for (int axis = 0; axis < 3; ++axis) corner_[k][axis][lane] = t.corner[k][axis];
    }
    atom_[lane] = t.atom == kNoSphere ? kNoAtom : std::int64_t{t.atom};
  }
  void complete(std::size_t count);

  Vec3d corner(std::size_t lane, std::size_t k) const {
    return {corner_[k][0][lane], corner_[k][1][lane], corner_[k][2][lane]};
  }

  std::uint32_t overlapping(const PatchLanes& other, std::size_t lane) const;
  std::uint32_t may_cross(const PatchLanes& other, std::size_t lane) const;

 private:
  static constexpr std::int64_t kNoAtom = -1;
  struct Straddling {
    LaneBits above, below;  // whether some corner was found above, or below
    void add(const Lanes (&normal)[3], const Lanes (&base)[3], const Lanes (&p)[3]);
  };

  alignas(32) double corner_[3][3][kLanes];  // Å, by corner, axis and lane
  alignas(32) double normal_[3][kLanes], lower_[3][kLanes], upper_[3][kLanes];
  alignas(32) std::int64_t vertex_[3][kLanes], atom_[kLanes];
};

// Completes the first `count` lanes, which have been set. The others get empty boxes.
VDWMESH_INLINE void PatchLanes::complete(std::size_t count) {
  for (std::size_t l = count; l < kLanes; ++l) set(l, {{}, {}, kNoSphere});
  Lanes u[3], v[3];
  for (int axis = 0; axis < 3; ++axis) {
    const Lanes a = lanes_at(corner_[0][axis]), b = lanes_at(corner_[1][axis]),
                c = lanes_at(corner_[2][axis]);
    u[axis] = b - a;
    v[axis] = c - a;
    const Lanes least = a < b ? a : b, most = a > b ? a : b;
    store_lanes(lower_[axis], least < c ? least : c);
    store_lanes(upper_[axis], most > c ? most : c);
    for (std::size_t l = count; l < kLanes; ++l) {
      lower_[axis][l] = std::numeric_limits<double>::infinity();
      upper_[axis][l] = -lower_[axis][l];
    }
  }
  for (int axis = 0; axis < 3; ++axis) {  // the operations of cross() in their order
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    store_lanes(normal_[axis], u[j] * v[k] - u[k] * v[j]);
  }
}

// A mask of the triangles whose boxes have a point in common with that of triangle `lane` of
// `other`.
VDWMESH_INLINE std::uint32_t PatchLanes::overlapping(const PatchLanes& other,
                                                     std::size_t lane) const {
  LaneBits all = all_bits(-1);
  for (int axis = 0; axis < 3; ++axis) {
    all &= lanes_at(lower_[axis]) <= all_lanes(other.upper_[axis][lane]);
    all &= lanes_at(upper_[axis]) >= all_lanes(other.lower_[axis][lane]);
  }
  return bits_of(all);
}

// Notes in each lane on which side of a plane point p lies. The plane goes through `base` and has
// the normal `normal`.
VDWMESH_INLINE void PatchLanes::Straddling::add(const Lanes (&normal)[3], const Lanes (&base)[3],
                                                const Lanes (&p)[3]) {
  constexpr double kRounding = 0x1p-51, kUnderflow = 0x1p-1010;
  const Lanes x = normal[0] * (p[0] - base[0]), y = normal[1] * (p[1] - base[1]),
              z = normal[2] * (p[2] - base[2]);
  const Lanes side = x + y + z;
  const Lanes bound =
      kRounding * (magnitude_of(x) + magnitude_of(y) + magnitude_of(z)) + kUnderflow;
  above |= side > bound;
  below |= side < -bound;
}

// A mask of the triangles that may cross triangle `lane` of `other`, whatever their boxes are.
// `their_normal` and `their_base` are of that triangle, `our_normal` and `our_base` of the
// triangles here.
VDWMESH_INLINE std::uint32_t PatchLanes::may_cross(const PatchLanes& other,
                                                   std::size_t lane) const {
  Lanes their_normal[3], their_base[3], our_normal[3], our_base[3];
  for (int axis = 0; axis < 3; ++axis) {
    their_normal[axis] = all_lanes(other.normal_[axis][lane]);
    their_base[axis] = all_lanes(other.corner_[0][axis][lane]);
    our_normal[axis] = lanes_at(normal_[axis]);
    our_base[axis] = lanes_at(corner_[0][axis]);
  }
  const LaneBits none = all_bits(0);
  Straddling at_their_plane{none, none}, at_our_plane{none, none};
  LaneBits shared = none;  // minus the number of shared vertices, because true is -1 in a lane
  for (std::size_t k = 0; k < 3; ++k) {
    Lanes their_corner[3], our_corner[3];
    for (int axis = 0; axis < 3; ++axis) {
      their_corner[axis] = all_lanes(other.corner_[k][axis][lane]);
      our_corner[axis] = lanes_at(corner_[k][axis]);
    }
    at_their_plane.add(their_normal, their_base, our_corner);
    at_our_plane.add(our_normal, our_base, their_corner);
    const LaneBits vertex = all_bits(other.vertex_[k][lane]);
    shared += (bits_at(vertex_[0]) == vertex) | (bits_at(vertex_[1]) == vertex) |
              (bits_at(vertex_[2]) == vertex);
  }
  const LaneBits atom = bits_at(atom_);
  const LaneBits one_atom = (atom == all_bits(other.atom_[lane])) & (atom != kNoAtom);
  const LaneBits neighbours = (shared < -1) | (one_atom & (shared < 0));
  const LaneBits straddle =
      (at_their_plane.above & at_their_plane.below) | (at_our_plane.above & at_our_plane.below);
  return bits_of(straddle & ~neighbours);
}

}  // namespace vdwmesh
