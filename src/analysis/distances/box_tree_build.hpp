// What building a BoxTree computes for one primitive or one node, for host and device.
//
// A tree is built in these steps, each of them parallel over its output:
//  1. Sort the primitives by MortonKeys of the centres of their boxes.
//  2. node_over() the boxes of every eight consecutive primitives is a node of level 0.
//  3. node_over() the boxes of every eight consecutive nodes is a node of the next level, until
//     there is only one node, the root.
//
// All coordinates are scaled: the world of the tree, a box that contains all primitives and all
// later queries, is mapped into [-1, 1]³ with its middle at 0. The principle is the linear BVH of
// C. Lauterbach et al. (Computer Graphics Forum 28 (2009) 375).
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "analysis/distances/box_tree_view.hpp"
#include "core/host_device.hpp"
#include "core/order/morton.hpp"
#include "spheres/box.hpp"

namespace vdwmesh {

// Returns a view of a tree in this world that has no primitives yet. One scale for all axes, so
// that scaled distances are proportional to distances in Å. If `world` is a single point, any scale
// will do.
inline BoxTreeView view_in(const Box& world) {
  const Vec3d extent = world.upper - world.lower;
  const double half = 0.5 * std::max({extent.x, extent.y, extent.z});
  BoxTreeView view{};
  view.center = middle(world);
  view.scale = half > 0 ? 1 / half : 1;
  return view;
}

VDWMESH_HD inline Vec3d scaled(const BoxTreeView& view, const Vec3d& p) {
  return view.scale * (p - view.center);
}
VDWMESH_HD inline Box scaled(const BoxTreeView& view, const Box& box) {
  return {scaled(view, box.lower), scaled(view, box.upper)};
}

// Keys whose order puts primitives that are near each other next to each other. A key has the index
// of the primitive in its lower bits and the Morton code of its centre, its position along the
// Z-order curve, in all others, with up to 21 bits per axis. The keys are unique, so their sorted
// order does not depend on the algorithm. An index has at most 32 bits, so the code has at least 10
// bits per axis.
class MortonKeys {
 public:
  explicit MortonKeys(std::uint32_t count)
      : index_bits_(static_cast<int>(std::bit_width(count))),
        cells_(std::ldexp(1.0, std::min(21, (64 - index_bits_) / 3))) {}

  // The key of primitive i, whose box has its centre at the scaled point p.
  VDWMESH_HD std::uint64_t key(std::uint64_t i, const Vec3d& p) const {
    return morton_code(cell(p.x), cell(p.y), cell(p.z)) << index_bits_ | i;
  }
  int index_bits() const { return index_bits_; }
  VDWMESH_HD std::uint32_t index(std::uint64_t key) const {
    return static_cast<std::uint32_t>(key & ((std::uint64_t{1} << index_bits_) - 1));
  }

 private:
  VDWMESH_HD std::uint64_t cell(double x) const {
    const double place = 0.5 * (x + 1) * cells_;
    return static_cast<std::uint64_t>(place < 0 ? 0 : (place > cells_ - 1 ? cells_ - 1 : place));
  }

  int index_bits_;
  double cells_;  // along an axis
};

// The number of nodes that have `count` children together.
VDWMESH_HD constexpr std::uint64_t nodes_over(std::uint64_t count) {
  return (count + BoxNode::kWidth - 1) / BoxNode::kWidth;
}

// Makes node n of the nodes over `count` children: child l of it is child 8 n + l of all.
// scaled_box_of(i) returns the box of child i.
template <class BoxOf>
VDWMESH_HD inline BoxNode node_over(std::uint64_t n, std::uint64_t count,
                                    const BoxOf& scaled_box_of) {
  Box boxes[BoxNode::kWidth]{};  // GCC 14 does not see that every node has a child
  const std::uint64_t first = BoxNode::kWidth * n, left = count - first;
  const int here = left < BoxNode::kWidth ? static_cast<int>(left) : BoxNode::kWidth;
  for (int i = 0; i < here; ++i) boxes[i] = scaled_box_of(first + static_cast<std::uint64_t>(i));
  return make_box_node(boxes, here);
}

}  // namespace vdwmesh
