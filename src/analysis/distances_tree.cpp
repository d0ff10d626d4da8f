// Construction of BoxTree, a bounding volume hierarchy in Morton order. The search is in
// distances_tree.hpp.
//
// A node stores eight boxes, one around each of its eight children; the n-th box is called lane n,
// because vector instructions measure all eight at once. The children of a node of level 0 are
// leaves, the children of all other nodes are nodes of the level below. The steps are:
//  1. sort(): sort the primitives by the Morton code (Z-order) of the centres of their boxes.
//  2. make_leaves(): every four consecutive primitives form a leaf, which is not stored. The boxes
//     around every eight leaves form a node of level 0.
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

#include <bit>
#include <cmath>
#include <limits>

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

constexpr double kFar = std::numeric_limits<double>::infinity();
}  // namespace

BoxTree::BoxTree(std::uint32_t count, const Box& world,
                 const std::function<Box(std::uint32_t)>& box_of)
    : center_(middle(world)) {
  const Vec3d extent = world.upper - world.lower;
  // One scale for all axes, so that scaled distances are proportional to distances in Å. If `world`
  // is a single point, any scale will do.
  const double half = 0.5 * std::max({extent.x, extent.y, extent.z});
  scale_ = half > 0 ? 1 / half : 1;
  sort(count, box_of);
  make_leaves(box_of);
  make_levels();
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

// Stores the range [lower, upper] of one lane along one axis as its middle and half its length, in
// float. The half is extended by kInflate, whose definition in distances_tree.hpp shows that it
// covers all rounding. The range of an unused lane is empty: lower = infinity > upper = -infinity.
// Its half becomes -infinity. By squared_distances() such a lane is infinitely far from every
// query, so the search never enters it; and Node::lower() and Node::upper() return infinity and
// -infinity for it, so it does not extend the box around its node in the level above.
void BoxTree::Node::set(std::size_t lane, int axis, double lower, double upper) {
  const bool there = lower <= upper;
  center[axis][lane] = there ? static_cast<float>(0.5 * (lower + upper)) : 0;
  half[axis][lane] =
      there ? static_cast<float>(0.5 * (upper - lower)) + kInflate : -static_cast<float>(kFar);
}

// Makes level 0. Lane l of node n is the box of the leaf 8 n + l, which has the primitives
// order_[4 (8 n + l)] and the next three, or fewer if it is the last leaf. Lanes beyond the last
// leaf are unused: for them `first` is not below `end`, and `all` stays empty.
void BoxTree::make_leaves(const std::function<Box(std::uint32_t)>& box_of) {
  const std::size_t per_node = std::size_t{kLeaf} * kWidth;
  Buffer<Node> nodes((order_.size() + per_node - 1) / per_node);
  for_each_index(nodes.size(), [&](std::size_t n) {
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
      const std::size_t first = n * per_node + lane * kLeaf;
      const std::size_t end = std::min(first + kLeaf, order_.size());
      Box all = empty_box();
      for (std::size_t i = first; i < end; ++i) {
        const Box box = box_of(order_[i]);
        include(all, Box{scaled(box.lower), scaled(box.upper)});
      }
      for (int axis = 0; axis < 3; ++axis)
        nodes[n].set(lane, axis, all.lower[axis], all.upper[axis]);
    }
  });
  levels_.push_back(std::move(nodes));
}

// Makes all other levels. Lane l of node n is the box around all lanes of node 8 n + l of the level
// below, its child. set() extends it by kInflate once more, so the boxes of a level contain the
// boxes of the level below in float. The last node may have fewer than eight children; the test
// child < below.size() leaves its other lanes unused.
void BoxTree::make_levels() {
  while (levels_.back().size() > 1) {
    const Buffer<Node>& below = levels_.back();
    Buffer<Node> nodes((below.size() + kWidth - 1) / kWidth);
    for_each_index(nodes.size(), [&](std::size_t n) {
      for (std::size_t lane = 0; lane < kWidth; ++lane) {
        const std::size_t child = n * kWidth + lane;
        for (int axis = 0; axis < 3; ++axis) {
          double lower = kFar, upper = -kFar;
          for (std::size_t i = 0; child < below.size() && i < kWidth; ++i) {
            lower = std::min(lower, below[child].lower(i, axis));
            upper = std::max(upper, below[child].upper(i, axis));
          }
          nodes[n].set(lane, axis, lower, upper);
        }
      }
    });
    levels_.push_back(std::move(nodes));
  }
}

}  // namespace vdwmesh
