// BoxTree: a bounding volume hierarchy over boxes, for nearest-primitive queries.
//
// The search is visit_nearest() (box_tree_view.hpp); the caller measures the primitives themselves.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "analysis/distances/box_tree_view.hpp"
#include "core/buffer.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class BoxTree {
 public:
  // box_of(i) returns the box of primitive i < count, Å; several threads call it at the same time.
  // Precondition: all boxes and all later query points are in `world`, and count is above 0.
  BoxTree(std::uint32_t count, const Box& world, const std::function<Box(std::uint32_t)>& box_of);

  BoxTree(const BoxTree&) = delete;
  BoxTree& operator=(const BoxTree&) = delete;

  // Valid as long as the tree.
  const BoxTreeView& view() const { return view_; }

  // Upper bound of the bytes for building and keeping a tree of `count` primitives. The index of a
  // primitive takes 4 bytes, and its box an eighth of a node of 64 bytes. Every level has an eighth
  // of the nodes of the level below, and 1 + 1/8 + 1/64 + … is 8/7, so the boxes of all levels take
  // 8 · 8/7 = 9.15 bytes per primitive: 13.15 in all. While they are sorted, the keys take 8 bytes
  // twice. 4096 bytes are for the nodes of each level that are not full.
  static std::uint64_t bytes(std::uint64_t count) { return 16 * count + 4096; }

 private:
  void sort(std::uint32_t count, const std::function<Box(std::uint32_t)>& box_of);
  void make_levels(const std::function<Box(std::uint32_t)>& box_of);

  Buffer<std::uint32_t> order_;          // primitives in Morton order
  std::vector<Buffer<BoxNode>> levels_;  // level 0 first; the root last
  BoxTreeView view_{};
};

}  // namespace vdwmesh
