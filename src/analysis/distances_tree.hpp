// BoxTree: a bounding volume hierarchy over boxes, for nearest-primitive queries.
//
// A node has the boxes of eight children, in float, one per lane of a vector instruction. A leaf
// has four primitives. Children are found by index arithmetic, without pointers. The tree takes 11
// bytes per primitive, and 12 while it is built. The caller measures the primitives themselves.
#pragma once

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/buffer.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class BoxTree {
 public:
  // box_of(i) returns the box of primitive i < count, Å; several threads call it at the same time.
  // Precondition: all boxes and all later query points are in `world`.
  BoxTree(std::uint32_t count, const Box& world, const std::function<Box(std::uint32_t)>& box_of);

  // Calls visit(i, squared) for at least all primitives i whose box is nearer to p than √squared
  // (Å), near boxes first. visit lowers `squared` if primitive i is nearer. Needs count > 0.
  template <class Visit>
  void nearest(const Vec3d& p, double& squared, Visit&& visit) const;

  // Upper bound of the bytes for building and keeping a tree of `count` primitives.
  static std::uint64_t bytes(std::uint64_t count) { return 12 * count + 4096; }

 private:
  static constexpr int kWidth = 8;           // children of a node
  static constexpr std::uint32_t kLeaf = 4;  // primitives of a leaf
  static constexpr int kMaxLevels = 11;      // of nodes; 4 * 8^11 > 2^32 primitives
  // No box may seem farther from a query than it is. Scaled coordinates are in [-1, 1], so rounding
  // to float changes each by at most 2^-25 and a difference of two by at most 2^-24. kInflate, four
  // times 2^-24, extends every box. kSlack, a relative margin, covers the roundings of squares.
  static constexpr float kInflate = 0x1p-22F;
  static constexpr float kSlack = 1e-5F;

  // The scaled boxes of eight children: middle and half length by axis and lane. An unused lane has
  // the half -infinity, so that its distance from every point is infinite.
  struct alignas(32) Node {
    float center[3][kWidth], half[3][kWidth];
    void set(std::size_t lane, int axis, double lower, double upper);
    double lower(std::size_t lane, int axis) const {
      return double{center[axis][lane]} - half[axis][lane];
    }
    double upper(std::size_t lane, int axis) const {
      return double{center[axis][lane]} + half[axis][lane];
    }
  };
  struct Entry {          // of the search stack: a node or a leaf that is still to be examined
    float distance;       // squared and scaled, from the query to its box
    std::int32_t level;   // into levels_; -1 for a leaf
    std::uint32_t index;  // of the node in its level, or of the leaf
  };
  struct FloatPoint {
    float x, y, z;
  };

  void sort(std::uint32_t count, const std::function<Box(std::uint32_t)>& box_of);
  void make_leaves(const std::function<Box(std::uint32_t)>& box_of);
  void make_levels();
  Vec3d scaled(const Vec3d& p) const { return scale_ * (p - center_); }
  FloatPoint to_float(const Vec3d& p) const {
    const Vec3f f = cast<float>(scaled(p));
    return {f.x, f.y, f.z};
  }
  // The bound that the squared scaled distance of a box must be below. FLT_MIN keeps the bound
  // above 0, even if the square underflows, so that boxes at distance 0 are still visited.
  float bound_of(double squared) const {
    return static_cast<float>(squared * scale_ * scale_) * (1 + kSlack) + FLT_MIN;
  }
  static void squared_distances(const Node& node, const FloatPoint& p, float (&distance)[kWidth]);
  static std::uint32_t nearer_than(float bound, const float (&distance)[kWidth]);
  static int push(const Entry& entry, Entry* stack, int from, int size);

  Vec3d center_;                      // of the world box, Å
  double scale_;                      // 1/Å: half the longest side of that box becomes 1
  Buffer<std::uint32_t> order_;       // primitives in Morton order
  std::vector<Buffer<Node>> levels_;  // level 0, the parents of the leaves, first; the root last
};

// Computes the squared scaled distances to the eight boxes. Along an axis the distance is max(d, 0)
// with d = |p - center| - half. twice_outside() returns twice that, d + |d|, which needs no branch
// and can be vectorised; 0.25F takes the factor out of the sum of the squares.
inline void BoxTree::squared_distances(const Node& node, const FloatPoint& p,
                                       float (&distance)[kWidth]) {
  const auto twice_outside = [](float place, float center, float half) {
    const float beyond = std::abs(place - center) - half;
    return beyond + std::abs(beyond);
  };
  for (int i = 0; i < kWidth; ++i) {
    const float x = twice_outside(p.x, node.center[0][i], node.half[0][i]);
    const float y = twice_outside(p.y, node.center[1][i], node.half[1][i]);
    const float z = twice_outside(p.z, node.center[2][i], node.half[2][i]);
    distance[i] = 0.25F * (x * x + y * y + z * z);
  }
}

// Returns a mask whose bit i says that distance[i] is below the bound.
inline std::uint32_t BoxTree::nearer_than(float bound, const float (&distance)[kWidth]) {
  std::uint32_t near = 0;
  for (int i = 0; i < kWidth; ++i) near |= static_cast<std::uint32_t>(distance[i] < bound) << i;
  return near;
}

// Inserts an entry into stack[from … size - 1], whose distances decrease; returns the new size.
inline int BoxTree::push(const Entry& entry, Entry* stack, int from, int size) {
  int place = size;
  for (; place > from && stack[place - 1].distance < entry.distance; --place)
    stack[place] = stack[place - 1];
  stack[place] = entry;
  return size + 1;
}

// Depth-first branch and bound, nearest child first. The stack has room for the root and kWidth
// entries of each level. `near` is a bit mask of lanes; near &= near - 1 clears its lowest bit.
template <class Visit>
void BoxTree::nearest(const Vec3d& p, double& squared, Visit&& visit) const {
  const FloatPoint query = to_float(p);
  Entry stack[kMaxLevels * kWidth + 1];
  stack[0] = {0, static_cast<std::int32_t>(levels_.size()) - 1, 0};
  float bound = bound_of(squared);
  for (int size = 1; size > 0;) {
    const Entry entry = stack[--size];
    if (!(entry.distance < bound)) continue;
    if (entry.level < 0) {
      const std::size_t first = std::size_t{kLeaf} * entry.index;
      const std::size_t end = std::min(first + kLeaf, order_.size());
      for (std::size_t i = first; i < end; ++i) visit(order_[i], squared);
      bound = bound_of(squared);
      continue;
    }
    float distance[kWidth];
    squared_distances(levels_[static_cast<std::size_t>(entry.level)][entry.index], query, distance);
    const int from = size;
    for (std::uint32_t near = nearer_than(bound, distance); near != 0; near &= near - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(near));
      size = push({distance[i], entry.level - 1, kWidth * entry.index + i}, stack, from, size);
    }
  }
}

}  // namespace vdwmesh
