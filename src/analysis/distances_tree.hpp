// A tree of boxes for nearest-primitive queries, small beside what it sorts: eight boxes to a node,
// four primitives to a leaf, no pointers; 11 bytes per primitive, 12 while it is built.
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
  // Every primitive and every query lies in `world`. box_of(i) is called from several threads.
  BoxTree(std::uint32_t count, const Box& world, const std::function<Box(std::uint32_t)>& box_of);

  // Calls visit(i, squared) for all primitives whose box comes nearer to p than the square root
  // of `squared` (Å²), the nearer boxes first; visit lowers it.
  template <class Visit>
  void nearest(const Vec3d& p, double& squared, Visit&& visit) const;

  // The most that building and keeping a tree takes.
  static std::uint64_t bytes(std::uint64_t count) { return 12 * count + 4096; }

 private:
  static constexpr int kWidth = 8;
  static constexpr std::uint32_t kLeaf = 4;
  static constexpr int kMaxLevels = 11;  // 4 * 8^11 > 2^32
  // Coordinates are scaled to [-1, 1]. A float is then wrong by 2^-25, in box and query, and their
  // difference by 2^-24; boxes grow by four times that on every level.
  static constexpr float kInflate = 0x1p-22F;
  static constexpr float kSlack = 1e-5F;  // relative, of squared lengths: many float roundings

  // Lanes without a box have the half -infinity: nothing is near them.
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
    float distance;
    std::int32_t level;  // -1: a leaf
    std::uint32_t index;
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
  float bound_of(double squared) const {
    return static_cast<float>(squared * scale_ * scale_) * (1 + kSlack) + FLT_MIN;
  }
  static void measure(const Node& node, const FloatPoint& p, float (&distance)[kWidth]);
  static std::uint32_t nearer_than(float bound, const float (&distance)[kWidth]);
  static int push(const Entry& entry, Entry* stack, int from, int size);

  Vec3d center_;
  double scale_;
  Buffer<std::uint32_t> order_;
  std::vector<Buffer<Node>> levels_;  // leaves first
};

// Squared scaled distances to the eight boxes. Without branches or comparisons, which would keep
// the compiler from using vector instructions.
inline void BoxTree::measure(const Node& node, const FloatPoint& p, float (&distance)[kWidth]) {
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

// As bits.
inline std::uint32_t BoxTree::nearer_than(float bound, const float (&distance)[kWidth]) {
  std::uint32_t near = 0;
  for (int i = 0; i < kWidth; ++i) near |= static_cast<std::uint32_t>(distance[i] < bound) << i;
  return near;
}

// Keeps the entries from `from` on in falling order of distance.
inline int BoxTree::push(const Entry& entry, Entry* stack, int from, int size) {
  int place = size;
  for (; place > from && stack[place - 1].distance < entry.distance; --place)
    stack[place] = stack[place - 1];
  stack[place] = entry;
  return size + 1;
}

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
    measure(levels_[static_cast<std::size_t>(entry.level)][entry.index], query, distance);
    const int from = size;
    for (std::uint32_t near = nearer_than(bound, distance); near != 0; near &= near - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(near));
      size = push({distance[i], entry.level - 1, kWidth * entry.index + i}, stack, from, size);
    }
  }
}

}  // namespace vdwmesh
