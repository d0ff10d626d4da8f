// Construction of BoxTree, a bounding volume hierarchy in Morton order. The search is in
// box_tree_view.hpp.
//
// A node stores eight boxes, one around each of its eight children; the n-th box is called lane n,
// because vector instructions measure all eight at once. The steps are:
//  1. sort(): sort the primitives by the Morton code (Z-order) of the centres of their boxes.
//  2. make_level_0(): the boxes of every eight consecutive primitives form a node of level 0.
//  3. make_levels(): the boxes around every eight consecutive nodes form a node of the next level,
//     until there is only one node, the root.
//
// All coordinates are scaled by scaled(), which maps the box `world` of the constructor into
// [-1, 1]³ with its middle at 0. `world` contains all primitives, so no coordinate is outside.
//
// Every step is parallel over its output, and the sort keys are unique, so the tree is the same for
// any number of threads. The principle is the linear BVH of C. Lauterbach et al. (Computer Graphics
// Forum 28 (2009) 375).
#include "analysis/distances_tree.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/fixed_blocks.hpp"
#include "core/morton.hpp"
#include "surface/box.hpp"

namespace vdwmesh {
namespace {

// Returns the Morton code of a point of [-1, 1]³: its position along the Z-order curve through
// 2^bits cells per axis. Points with near codes are mostly near each other, so consecutive
// primitives have a small common box.
std::uint64_t morton(const Vec3d& p, int bits) {
  const double cells = std::ldexp(1.0, bits);
  const auto cell = [&](double x) {
    return static_cast<std::uint64_t>(std::clamp(0.5 * (x + 1) * cells, 0.0, cells - 1));
  };
  return morton_code(cell(p.x), cell(p.y), cell(p.z));
}

}  // namespace

BoxTree::BoxTree(std::uint32_t count, const Box& world,
                 const std::function<Box(std::uint32_t)>& box_of) {
  view_.center = middle(world);
  const Vec3d extent = world.upper - world.lower;
  // One scale for all axes, so that scaled distances are proportional to distances in Å. If `world`
  // is a single point, any scale will do.
  const double half = 0.5 * std::max({extent.x, extent.y, extent.z});
  view_.scale = half > 0 ? 1 / half : 1;
  sort(count, box_of);
  make_level_0(box_of);
  make_levels();
  view_.order = order_.data();
  view_.level_count = static_cast<int>(levels_.size());
  for (std::size_t l = 0; l < levels_.size(); ++l) view_.levels[l] = levels_[l].data();
}

// A key has the index of the primitive in its lower bits and the Morton code in all others, with
// up to 21 bits per axis. The keys are unique, so their sorted order does not depend on the
// algorithm. An index has at most 32 bits, so the code has at least 10 bits per axis.
void BoxTree::sort(std::uint32_t count, const std::function<Box(std::uint32_t)>& box_of) {
  const int index_bits = std::bit_width(count);
  const int axis_bits = std::min(21, (64 - index_bits) / 3);
  Buffer<std::uint64_t> keys(count);
  for_each_index(count, [&](std::size_t i) {
    const Vec3d p = scaled(middle(box_of(static_cast<std::uint32_t>(i))));
    keys[i] = morton(p, axis_bits) << index_bits | i;
  });
  tbb::parallel_sort(keys.begin(), keys.end());
  order_.resize(count);
  const std::uint64_t mask = (std::uint64_t{1} << index_bits) - 1;
  for_each_index(count,
                 [&](std::size_t i) { order_[i] = static_cast<std::uint32_t>(keys[i] & mask); });
}

// Makes level 0. Lane l of node n is the box of the primitive order_[8 n + l].
void BoxTree::make_level_0(const std::function<Box(std::uint32_t)>& box_of) {
  Buffer<BoxNode> nodes((order_.size() + BoxNode::kWidth - 1) / BoxNode::kWidth);
  for_each_index(nodes.size(), [&](std::size_t n) {
    const std::size_t first = n * BoxNode::kWidth;
    const std::size_t end = std::min(first + BoxNode::kWidth, order_.size());
    std::array<Box, BoxNode::kWidth> boxes;
    for (std::size_t i = first; i < end; ++i) {
      const Box box = box_of(order_[i]);
      boxes[i - first] = {scaled(box.lower), scaled(box.upper)};
    }
    nodes[n] = make_box_node(boxes.data(), static_cast<int>(end - first));
  });
  levels_.push_back(std::move(nodes));
}

// Makes all other levels. Lane l of node n is the box around node 8 n + l of the level below.
void BoxTree::make_levels() {
  while (levels_.back().size() > 1) {
    const Buffer<BoxNode>& below = levels_.back();
    Buffer<BoxNode> nodes((below.size() + BoxNode::kWidth - 1) / BoxNode::kWidth);
    for_each_index(nodes.size(), [&](std::size_t n) {
      const std::size_t first = n * BoxNode::kWidth;
      const std::size_t end = std::min(first + BoxNode::kWidth, below.size());
      std::array<Box, BoxNode::kWidth> boxes;
      for (std::size_t i = first; i < end; ++i) boxes[i - first] = vdwmesh::box_of(below[i]);
      nodes[n] = make_box_node(boxes.data(), static_cast<int>(end - first));
    });
    levels_.push_back(std::move(nodes));
  }
}

}  // namespace vdwmesh
