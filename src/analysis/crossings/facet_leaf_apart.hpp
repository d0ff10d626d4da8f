// not_apart(): finds most pairs of a triangle and four others apart, by the signs of tetrahedron
// volumes; facet_pair.hpp decides what is left.
//
// A pair is apart if the corners of one triangle that the other does not share lie on one side of
// the other's plane for certain. Which corners are shared is not asked. Let s be the number of
// shared vertices. If no corner is on the negative side for certain, and 3 - s are on the positive
// side for certain, then these 3 - s are the corners that are not shared: a shared corner lies in
// the plane, and is never put on a side for certain. With s = 3 the triangles coincide, and are not
// apart.
//
// The bound. side_of() in facet_pair.hpp is certain of a side if the size of the computed volume
// exceeds 16 ε Σ |w_i| m_i + kTiny, with w from the plane's first corner to the point. Here each
// |w_i|, as computed, is at most the reach, the longest side of a box around both triangles,
// because rounding keeps order. FacetLeaf::magnitude is Σ m_i and 2^-20 of that. The addition
// exceeds the roundings of all sums and products here and in side_of(), also those below 2^-1022,
// for every m_i is at least 2^-1000. A product with 16 ε may lose 2^-1075 of its own, and kTiny of
// side_of() is 2^-1060; 2 kTiny is more than both. So a side that is certain here is certain there.
//
// Overflow: the computed volume and all parts of it are at most reach · magnitude. If they
// overflow, so does this, and the bound; then, and for what is not a number, no comparison with the
// bound holds, and nothing is certain.
#pragma once

#include <cstdint>
#include <cstring>

#include "analysis/crossings/facet_leaf.hpp"

namespace vdwmesh {

// By lane, minus the number of vertices that triangle i of `other` shares.
VDWMESH_INLINE LaneBits shared_vertices(const FacetLeaf& leaf, const FacetLeaf& other,
                                        std::size_t i) {
  using Ids = std::uint32_t __attribute__((vector_size(kLanes * sizeof(std::uint32_t))));
  using Masks = std::int32_t __attribute__((vector_size(kLanes * sizeof(std::int32_t))));
  Masks shared{};
  for (std::size_t k = 0; k < 3; ++k) {
    Ids own;
    std::memcpy(&own, leaf.vertex[k], sizeof own);
    for (std::size_t l = 0; l < 3; ++l) shared += own == Ids{} + other.vertex[l][i];
  }
  return __builtin_convertvector(shared, LaneBits);
}

// By lane, minus the number of corners on the positive and on the negative side of a plane for
// certain: sums of masks.
struct LaneSides {
  LaneBits above{}, below{};

  VDWMESH_INLINE void add(const Lanes (&base)[3], const Lanes (&normal)[3], const Lanes& bound,
                          const Lanes (&p)[3]) {
    const Lanes volume =
        (p[0] - base[0]) * normal[0] + (p[1] - base[1]) * normal[1] + (p[2] - base[2]) * normal[2];
    above += volume > bound;
    below += volume < -bound;
  }
  // A mask of the lanes in which all corners but `shared` are on one side.
  VDWMESH_INLINE std::uint32_t one_side(const LaneBits& shared) const {
    const LaneBits all = all_bits(-3), none = all_bits(0), wanted = all - shared;
    const LaneBits only_above = (above == wanted) & (below == none);
    const LaneBits only_below = (below == wanted) & (above == none);
    return bits_of((only_above | only_below) & (shared != all));
  }
};

VDWMESH_INLINE Lanes bound_of(const Lanes& magnitude, double reach) {
  return kSideBound * (reach * magnitude) + 2 * kTiny;
}

// Of the triangles `near` of the leaf (a mask), those that are not found apart from triangle i of
// `other`. `reach` is at least the longest side of a box around both leaves.
VDWMESH_INLINE std::uint32_t not_apart(const FacetLeaf& leaf, std::uint32_t near,
                                       const FacetLeaf& other, std::size_t i, double reach) {
  const LaneBits shared = shared_vertices(leaf, other, i);
  Lanes base[3], normal[3];
  for (int axis = 0; axis < 3; ++axis) {
    base[axis] = other.corner[0].axis(axis, i);
    normal[axis] = other.normal.axis(axis, i);
  }
  LaneSides of_leaf;  // beside the plane of the other triangle
  const Lanes its_bound = bound_of(all_lanes(other.magnitude[i]), reach);
  for (const LaneVector& corner : leaf.corner) {
    of_leaf.add(base, normal, its_bound, {corner.axis(0), corner.axis(1), corner.axis(2)});
  }
  near &= ~of_leaf.one_side(shared);
  if (near == 0) return 0;
  for (int axis = 0; axis < 3; ++axis) {
    base[axis] = leaf.corner[0].axis(axis);
    normal[axis] = leaf.normal.axis(axis);
  }
  LaneSides of_other;  // beside the planes of the leaf
  const Lanes own_bound = bound_of(lanes_at(leaf.magnitude), reach);
  for (const LaneVector& corner : other.corner) {
    of_other.add(base, normal, own_bound,
                 {corner.axis(0, i), corner.axis(1, i), corner.axis(2, i)});
  }
  return near & ~of_other.one_side(shared);
}

}  // namespace vdwmesh
