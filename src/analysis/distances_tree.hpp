// BoxTree: a bounding volume hierarchy over boxes, for nearest-primitive queries.
//
// It takes 14 bytes per primitive. The search is visit_nearest() (box_tree_view.hpp); the caller
// measures the primitives themselves.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "analysis/box_tree_view.hpp"
#include "core/buffer.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class BoxTree {
 public:
  // box_of(i) returns the box of primitive i < count, Å; several threads call it at the same time.
  // Precondition: all boxes and all later query points are in `world`, and count > 0.
  BoxTree(std::uint32_t count, const Box& world, const std::function<Box(std::uint32_t)>& box_of);

  BoxTree(const BoxTree&) = delete;
  BoxTree& operator=(const BoxTree&) = delete;

  // Valid as long as the tree.
  const BoxTreeView& view() const { return view_; }

  // Upper bound of the bytes for building and keeping a tree of `count` primitives: 4 for the index
  // of a primitive, 8 for its box, and 8/7 of that for the nodes of all levels above.
  static std::uint64_t bytes(std::uint64_t count) { return 132 * count / 10 + 4096; }

 private:
  Vec3d scaled(const Vec3d& p) const { return view_.scale * (p - view_.center); }
  void sort(std::uint32_t count, const std::function<Box(std::uint32_t)>& box_of);
  void make_level_0(const std::function<Box(std::uint32_t)>& box_of);
  void make_levels();

  Buffer<std::uint32_t> order_;          // primitives in Morton order
  std::vector<Buffer<BoxNode>> levels_;  // level 0 first; the root last
  BoxTreeView view_{};
};

}  // namespace vdwmesh
