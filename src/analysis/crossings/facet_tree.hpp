// FacetTree: a bounding volume hierarchy over triangles of a mesh, to find all pairs of triangles
// whose bounding boxes overlap.
//
// A leaf has four triangles, a node the boxes of eight children. Children are found by index
// arithmetic. The boxes are in double and only compared, never computed with, so the search loses
// no pair, whatever the coordinates are. The tree takes 18 bytes per triangle, and 20 while it is
// built.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "analysis/survey/mesh_area.hpp"
#include "core/buffer.hpp"
#include "core/lanes/lane_masks.hpp"
#include "core/no_index.hpp"
#include "spheres/box.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

class FacetTree {
 public:
  static constexpr std::size_t kLeaf = 4;   // triangles of a leaf
  static constexpr std::size_t kWidth = 8;  // children of a node

  // Over the triangles of the mesh, in an order that it makes. Those with a hub are in no box, if
  // `hubs` says by triangle which have one (hub_pairs.hpp); it must outlast the tree, if it is not
  // empty. Precondition: the coordinates are finite.
  FacetTree(const IndexedMesh& mesh, const Buffer<std::uint32_t>& hubs);

  std::size_t size() const { return order_.size(); }
  // The triangle of the mesh at a place of the tree's order. Leaf k has the places from kLeaf k.
  std::uint32_t triangle_at(std::size_t place) const { return order_[place]; }
  bool is_left_out(std::uint32_t triangle) const {
    return !hubs_.empty() && hubs_[triangle] != kNoIndex;
  }
  // The number of nodes whose children are leaves. Node n has the leaves from kWidth n.
  std::size_t bottom_nodes() const { return levels_.empty() ? 0 : levels_.front().size(); }

  // A mask of the leaves of a bottom node whose boxes overlap the given one.
  std::uint32_t overlapping_leaves(std::size_t node, const Box& box) const {
    return overlapping(levels_.front()[node], box);
  }
  // The box of a leaf of a bottom node.
  Box box_of_leaf(std::size_t node, std::size_t leaf) const {
    const Node& n = levels_.front()[node];
    return {{n.lower[0][leaf], n.lower[1][leaf], n.lower[2][leaf]},
            {n.upper[0][leaf], n.upper[1][leaf], n.upper[2][leaf]}};
  }
  // Calls visit(node) for all bottom nodes from `first` on whose boxes overlap the given one, and
  // for some whose leaves do not.
  template <class Visit>
  void visit_nodes_from(std::size_t first, const Box& box, const Visit& visit) const;

  // Upper bound of the bytes for building and keeping a tree of `count` triangles.
  static std::uint64_t bytes(std::uint64_t count) { return 20 * count + 4096; }

 private:
  static constexpr int kMaxLevels = 11;  // of nodes; 4 · 8^11 > 2^32 triangles

  struct alignas(32) Node {
    double lower[3][kWidth], upper[3][kWidth];  // Å, by axis and child; unused ones are empty
    void set(std::size_t child, const Box& box);
    Box all() const;
  };
  static std::uint32_t overlapping(const Node& node, const Box& box);
  void make_bottom(const IndexedMesh& mesh);
  void make_levels();

  std::span<const std::uint32_t> hubs_;
  Buffer<std::uint32_t> order_;
  std::vector<Buffer<Node>> levels_;  // the bottom nodes first, the root last
};

// The bounding box of a triangle.
inline Box box_of(const IndexedMesh& mesh, std::uint32_t triangle) {
  return box_of(corners_of(mesh, triangle));
}

// Whether boxes overlap the given one: four of them, whose ends along an axis stand one after the
// other at lower[axis] and upper[axis]. Boxes that touch overlap.
template <std::size_t stride>
VDWMESH_INLINE std::uint32_t overlapping_lanes(const double (&lower)[3][stride],
                                               const double (&upper)[3][stride], std::size_t first,
                                               const Box& box) {
  LaneBits all = {-1, -1, -1, -1};
  for (int axis = 0; axis < 3; ++axis) {
    all &= lanes_at(lower[axis] + first) <= all_lanes(box.upper[axis]);
    all &= lanes_at(upper[axis] + first) >= all_lanes(box.lower[axis]);
  }
  return bits_of(all);
}

inline std::uint32_t FacetTree::overlapping(const Node& node, const Box& box) {
  return overlapping_lanes(node.lower, node.upper, 0, box) |
         overlapping_lanes(node.lower, node.upper, kLanes, box) << kLanes;
}

// Depth first. A child of which all bottom nodes come before `first` is left out: those of the
// ancestor of `first` in a level and of all that follow it do not. The stack has room for the root
// and kWidth entries of each level.
template <class Visit>
void FacetTree::visit_nodes_from(std::size_t first, const Box& box, const Visit& visit) const {
  std::pair<std::size_t, std::size_t> stack[kMaxLevels * kWidth + 1];  // levels and indices
  stack[0] = {levels_.size() - 1, 0};
  for (int size = 1; size > 0;) {
    const auto [level, index] = stack[--size];
    if (level == 0) {
      visit(index);
      continue;
    }
    const std::size_t below = level - 1;
    const std::size_t least = first >> (std::bit_width(kWidth) - 1) * below;
    std::uint32_t children = overlapping(levels_[level][index], box);
    for (; children != 0; children &= children - 1) {
      const std::size_t child =
          kWidth * index + static_cast<std::size_t>(std::countr_zero(children));
      if (child >= least) stack[size++] = {below, child};
    }
  }
}

}  // namespace vdwmesh
