// FacetLeaf: the four triangles of a leaf of a FacetTree side by side, gathered from the mesh for
// tests of one triangle against all four at once (facet_leaf_apart.hpp). Triangles without an area
// are left out.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "analysis/crossings/facet_pair.hpp"
#include "analysis/crossings/facet_pair_exact.hpp"
#include "analysis/crossings/facet_tree.hpp"

namespace vdwmesh {

// Three coordinates of four triangles, by axis.
struct LaneVector {
  double at[3][kLanes];
  Lanes axis(int i) const { return lanes_at(at[i]); }
  Lanes axis(int i, std::size_t lane) const { return all_lanes(at[i][lane]); }
  Vec3d lane(std::size_t i) const { return {at[0][i], at[1][i], at[2][i]}; }
  void set(std::size_t i, const Vec3d& v) { at[0][i] = v.x, at[1][i] = v.y, at[2][i] = v.z; }
};

struct FacetLeaf {
  static constexpr std::size_t kSize = FacetTree::kLeaf;
  static_assert(kSize == kLanes);

  double lower[3][kSize], upper[3][kSize];  // the boxes of the triangles, by axis
  LaneVector corner[3], normal;             // as in Facet
  double magnitude[kSize];                  // Σ m_i and a margin: see facet_leaf_apart.hpp
  std::uint32_t vertex[3][kSize];           // indices
  Box box;                                  // around all of them
  std::array<std::uint32_t, kSize> triangle;

  Box box_at(std::size_t i) const {
    return {{lower[0][i], lower[1][i], lower[2][i]}, {upper[0][i], upper[1][i], upper[2][i]}};
  }
  Facet facet_at(std::size_t i) const {
    return make_facet({vertex[0][i], vertex[1][i], vertex[2][i]}, corner[0].lane(i),
                      corner[1].lane(i), corner[2].lane(i));
  }
  // A mask of the triangles whose boxes overlap the given one.
  std::uint32_t overlapping(const Box& other) const {
    return overlapping_lanes(lower, upper, 0, other);
  }
  // Gathers a leaf of the tree. Boxes of triangles that are not there, that the tree leaves out, or
  // that have no area, are empty.
  void gather(const IndexedMesh& mesh, const FacetTree& tree, std::size_t leaf);
  void set_planes();
  void leave_out_flat(std::size_t count);
};

inline void FacetLeaf::gather(const IndexedMesh& mesh, const FacetTree& tree, std::size_t leaf) {
  box = empty_box();
  const std::size_t first = std::min(kSize * leaf, tree.size());
  const std::size_t count = std::min(kSize, tree.size() - first);
  for (std::size_t i = 0; i < kSize; ++i) {
    Box own = empty_box();
    triangle[i] = i < count ? tree.triangle_at(first + i) : 0;
    const bool is_there = i < count && !tree.is_left_out(triangle[i]);
    const Triangle& v = mesh.triangles[triangle[i]];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& p = mesh.positions[v[k]];
      vertex[k][i] = v[k];
      corner[k].set(i, p);
      if (is_there) include(own, p);
    }
    include(box, own);
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis][i] = own.lower[axis];
      upper[axis][i] = own.upper[axis];
    }
  }
  set_planes();
  leave_out_flat(count);
}

// Empties the boxes of those of the first `count` triangles that have no area. A component of the
// normal that exceeds the bound here exceeds that of has_area() too, because `magnitude` is at
// least each m_i. Nearly all triangles have one.
inline void FacetLeaf::leave_out_flat(std::size_t count) {
  constexpr double kBound = 0x1p-50;
  const Lanes bound = kBound * lanes_at(magnitude);
  LaneBits has_area_for_certain = all_bits(0);
  for (int axis = 0; axis < 3; ++axis) {
    has_area_for_certain |= magnitude_of(normal.axis(axis)) > bound;
  }
  std::uint32_t unsure = ~bits_of(has_area_for_certain) & ((1u << count) - 1);
  for (; unsure != 0; unsure &= unsure - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(unsure));
    const Facet facet = facet_at(i);
    if (has_area(facet) || !is_flat_exactly(facet)) continue;
    const Box none = empty_box();
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis][i] = none.lower[axis];
      upper[axis][i] = none.upper[axis];
    }
  }
}

// The operations of set_plane() in facet_pair.hpp, for four triangles. The margin of `magnitude` is
// explained in facet_leaf_apart.hpp.
inline void FacetLeaf::set_planes() {
  constexpr double kMargin = 1 + 0x1p-20;
  Lanes u[3], v[3], sum = all_lanes(3 * kFloor);
  for (int axis = 0; axis < 3; ++axis) {
    u[axis] = corner[1].axis(axis) - corner[0].axis(axis);
    v[axis] = corner[2].axis(axis) - corner[0].axis(axis);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    const Lanes first = u[j] * v[k], second = u[k] * v[j];
    store_lanes(normal.at[axis], first - second);
    sum += magnitude_of(first) + magnitude_of(second);
  }
  store_lanes(magnitude, kMargin * sum);
}

}  // namespace vdwmesh
