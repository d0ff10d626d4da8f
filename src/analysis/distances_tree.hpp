// BoxTree: a bounding volume hierarchy over boxes, for nearest-primitive queries.
//
// A node has eight children, whose boxes are in float and are measured with vector instructions. A
// leaf has four primitives. Children are found by index arithmetic, without pointers. The tree
// takes 11 bytes per primitive, and 12 while it is built. The caller measures primitives itself.
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
  // (Å), boxes of near nodes first. visit lowers `squared` when it finds a nearer primitive.
  template <class Visit>
  void nearest(const Vec3d& p, double& squared, Visit&& visit) const;

  // Upper bound of the bytes for building and keeping a tree of `count` primitives.
  static std::uint64_t bytes(std::uint64_t count) { return 12 * count + 4096; }

 private:
  static constexpr int kWidth = 8;           // children of a node
  static constexpr std::uint32_t kLeaf = 4;  // primitives of a leaf
  static constexpr int kMaxLevels = 11;      // 4 * 8^11 > 2^32
  // No box may seem farther from a query than it is. Coordinates are scaled to [-1, 1], so rounding
  // to float changes each by at most 2^-25 and a difference of two by at most 2^-24. Every box is
  // extended by four times 2^-24. kSlack, which is relative, covers the roundings of squares.
  static constexpr float kInflate = 0x1p-22F;
  static constexpr float kSlack = 1e-5F;

  // The boxes of eight children, axis by axis. An unused lane has the half -infinity, so that its
  // distance from every point is infinite.
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
  struct Entry {
    float distance;       // squared and scaled, from the query to the box
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
  // The squared scaled distance that a box must be below. FLT_MIN keeps it above 0 if the square
  // underflows, so that boxes at distance 0 are still visited.
  float bound_of(double squared) const {
    return static_cast<float>(squared * scale_ * scale_) * (1 + kSlack) + FLT_MIN;
  }
  static void squared_distances(const Node& node, const FloatPoint& p, float (&distance)[kWidth]);
  static std::uint32_t nearer_than(float bound, const float (&distance)[kWidth]);
  static int push(const Entry& entry, Entry* stack, int from, int size);

  Vec3d center_;                      // of the world box, Å
  double scale_;                      // 1/Å: half the longest side of that box becomes 1
  Buffer<std::uint32_t> order_;       // primitives in Morton order
  std::vector<Buffer<Node>> levels_;  // the parents of the leaves first, the root last
};

// Computes the squared scaled distances to the eight boxes. Along an axis the distance is max(d, 0)
// with d = |p - center| - half. Written as (d + |d|) / 2 it needs no branches and can be
// vectorised.
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

// Inserts an entry into stack[from … size], which is in decreasing order of distance.
inline int BoxTree::push(const Entry& entry, Entry* stack, int from, int size) {
  int place = size;
  for (; place > from && stack[place - 1].distance < entry.distance; --place)
    stack[place] = stack[place - 1];
  stack[place] = entry;
  return size + 1;
}

// Depth-first branch and bound. Each level removes one stack entry before it adds at most kWidth.
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
