// The nodes of a BoxTree and the search in them, for host and device.
//
// A node has the boxes of eight children. Their sides are whole numbers of steps from the lower
// corner of the node, rounded outward, and a step is about 1/255 of the node's extent. A side is
// thus one byte, and a node fits a cache line of 64 bytes. (H. Ylitie, T. Karras and S. Laine,
// "Efficient incoherent ray traversal on GPUs through compressed wide BVHs", HPG 2017, store boxes
// in this way.) Coordinates are scaled: the world of the tree becomes [-1, 1]³. The children of a
// node of level 0 are primitives; those of all other nodes are nodes of the level below, found by
// index arithmetic.
#pragma once

#include <bit>
#include <cfloat>
#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Eight boxes. Along each axis, box i is the interval from origin + lower[i] · 2^exponent up to
// origin + upper[i] · 2^exponent.
struct alignas(64) BoxNode {
  static constexpr int kWidth = 8;  // children of a node, one per lane of a vector instruction
  float origin[3];
  std::int8_t exponent[3];
  std::uint8_t count;  // of the children: the lanes from here on are unused
  std::uint8_t lower[3][kWidth], upper[3][kWidth];
};
static_assert(sizeof(BoxNode) == 64);

// No box may seem farther from a query than it is. Scaled coordinates are in [-1, 1]. Rounding a
// query to float moves it by at most 2^-25. The three float operations between the query and a side
// of a box have results of at most 4 and round by at most 2^-23 each. kBoxMargin, 2^-21, is more
// than the sum. kBoxSlack, a relative margin, covers the roundings of squares.
inline constexpr float kBoxMargin = 0x1p-21F;
inline constexpr float kBoxSlack = 1e-5F;

// Returns 2^exponent for exponents of at least -126.
VDWMESH_HD inline float power_of_two(int exponent) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(exponent + 127) << 23);
}

// Makes the node of `count` children with these boxes, in scaled coordinates. The origin is below
// the lowest side, because kBoxMargin exceeds its rounding to float, so the extent is above 0. The
// exponent is the least for which 255 steps reach the highest side, so no number exceeds 255.
VDWMESH_HD inline BoxNode make_box_node(const Box* boxes, int count) {
  BoxNode node{};
  node.count = static_cast<std::uint8_t>(count);
  for (int axis = 0; axis < 3; ++axis) {
    double lower = boxes[0].lower[axis], upper = boxes[0].upper[axis];
    for (int i = 1; i < count; ++i) {
      lower = boxes[i].lower[axis] < lower ? boxes[i].lower[axis] : lower;
      upper = boxes[i].upper[axis] > upper ? boxes[i].upper[axis] : upper;
    }
    node.origin[axis] = static_cast<float>(lower - static_cast<double>(kBoxMargin));
    const auto origin = static_cast<double>(node.origin[axis]);
    int exponent = std::ilogb((upper - origin) / 255);
    while (255 * static_cast<double>(power_of_two(exponent)) < upper - origin) ++exponent;
    node.exponent[axis] = static_cast<std::int8_t>(exponent);
    const double per_unit = 1 / static_cast<double>(power_of_two(exponent));
    for (int i = 0; i < count; ++i) {
      node.lower[axis][i] =
          static_cast<std::uint8_t>(std::floor((boxes[i].lower[axis] - origin) * per_unit));
      node.upper[axis][i] =
          static_cast<std::uint8_t>(std::ceil((boxes[i].upper[axis] - origin) * per_unit));
    }
  }
  return node;
}

// Returns the box around all children, in scaled coordinates.
VDWMESH_HD inline Box box_of(const BoxNode& node) {
  Box box{};
  for (int axis = 0; axis < 3; ++axis) {
    int first = 255, last = 0;
    for (int i = 0; i < node.count; ++i) {
      first = node.lower[axis][i] < first ? node.lower[axis][i] : first;
      last = node.upper[axis][i] > last ? node.upper[axis][i] : last;
    }
    const auto origin = static_cast<double>(node.origin[axis]);
    const auto step = static_cast<double>(power_of_two(node.exponent[axis]));
    box.lower[axis] = origin + first * step;
    box.upper[axis] = origin + last * step;
  }
  return box;
}

// A query in scaled coordinates: a box, or a point if both corners are equal.
struct BoxQuery {
  float lower[3], upper[3];
};

// What the distances from a query to the boxes of a node have in common, by axis: how far the query
// is below and above the lower corner of the node, and the length of a step.
struct BoxSides {
  float below[3], above[3], step[3];

  VDWMESH_HD BoxSides(const BoxNode& node, const BoxQuery& query) {
    for (int axis = 0; axis < 3; ++axis) {
      below[axis] = node.origin[axis] - query.upper[axis] - kBoxMargin;
      above[axis] = query.lower[axis] - node.origin[axis] - kBoxMargin;
      step[axis] = power_of_two(node.exponent[axis]);
    }
  }
  // Returns the squared scaled distance from the query to box i; some number for an unused lane.
  // Along an axis the query is below the box by a, or above it by b, or neither is positive.
  VDWMESH_HD float squared_distance(const BoxNode& node, int i) const {
    float sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float a = below[axis] + step[axis] * static_cast<float>(node.lower[axis][i]);
      const float b = above[axis] - step[axis] * static_cast<float>(node.upper[axis][i]);
      const float larger = a > b ? a : b;
      const float outside = larger > 0 ? larger : 0;
      sum += outside * outside;
    }
    return sum;
  }
};

// Computes the squared scaled distances from the query to the eight boxes.
VDWMESH_HD inline void squared_distances(const BoxNode& node, const BoxQuery& query,
                                         float (&distance)[BoxNode::kWidth]) {
  const BoxSides sides(node, query);
  for (int i = 0; i < BoxNode::kWidth; ++i) distance[i] = sides.squared_distance(node, i);
}

// The tree as host and device code read it; trivially copyable, owns nothing.
struct BoxTreeView {
  static constexpr int kMaxLevels = 11;  // 8^11 > 2^32 primitives
  Vec3d center;                          // of the world, Å
  double scale;                          // 1/Å: half the longest side of the world becomes 1
  const std::uint32_t* order;            // primitives in Morton order
  int level_count;
  const BoxNode* levels[kMaxLevels];  // level 0, whose children are primitives, first

  // The point or box (Å) as a query.
  VDWMESH_HD BoxQuery query(const Vec3d& lower, const Vec3d& upper) const {
    const Vec3d a = scale * (lower - center), b = scale * (upper - center);
    return {{static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)},
            {static_cast<float>(b.x), static_cast<float>(b.y), static_cast<float>(b.z)}};
  }
  VDWMESH_HD BoxQuery query(const Vec3d& point) const { return query(point, point); }

  // The bound that the squared scaled distance of a box must be below. FLT_MIN keeps the bound
  // above 0 for every `squared` (Å²) from 0 on, so that boxes at distance 0 are still visited.
  VDWMESH_HD float bound_of(double squared) const {
    return static_cast<float>(squared * scale * scale) * (1 + kBoxSlack) + FLT_MIN;
  }
};

// An entry of the search stack: a node that is still to be examined.
struct BoxEntry {
  float distance;  // squared and scaled, from the query to its box
  std::int32_t level;
  std::uint32_t index;  // in its level
};

// Returns the index of the lowest set bit: how many bits are below it. Precondition: some bit is
// set.
VDWMESH_HD inline int lowest_bit(std::uint32_t bits) { return count_bits((bits & (0 - bits)) - 1); }

// The children of a node that may be nearer to the query than a bound: a bit for
// each lane, which near &= near - 1 clears from the lowest one on, and their distances.
struct NearLanes {
  std::uint32_t near;
  float distance[BoxNode::kWidth];  // squared and scaled

  VDWMESH_HD NearLanes(const BoxNode& node, const BoxQuery& query, float bound) : near(0) {
    squared_distances(node, query, distance);
    for (int i = 0; i < BoxNode::kWidth; ++i) {
      near |= static_cast<std::uint32_t>(distance[i] < bound) << i;
    }
    near &= (1u << node.count) - 1;
  }
};

// Calls visit(i, squared) for at least all primitives i of a node of level 0, given by its index,
// whose box is nearer to the query than √squared (Å). visit may lower `squared`. Near is NearLanes,
// or what computes the same.
template <class Near = NearLanes, class Visit>
VDWMESH_HD inline void visit_primitives(const BoxTreeView& tree, std::uint32_t index,
                                        const BoxQuery& query, double& squared, Visit&& visit) {
  float bound = tree.bound_of(squared);
  Near lanes(tree.levels[0][index], query, bound);
  for (; lanes.near != 0; lanes.near &= lanes.near - 1) {
    const int lane = lowest_bit(lanes.near);
    if (!(lanes.distance[lane] < bound)) continue;
    visit(tree.order[BoxNode::kWidth * index + static_cast<std::uint32_t>(lane)], squared);
    bound = tree.bound_of(squared);
  }
}

// Room of a search stack: for the root and seven of the eight children of each level.
inline constexpr int kBoxStack = BoxTreeView::kMaxLevels * BoxNode::kWidth + 1;

// Calls visit(i, squared) for at least all primitives i whose box is nearer to the query than
// √squared (Å), near boxes first. visit lowers `squared` if primitive i is nearer, and makes it
// negative to end the search. Depth-first branch and bound: the entries of a node are inserted such
// that the nearest one is on top of the stack.
template <class Near = NearLanes, class Visit>
VDWMESH_HD inline void visit_nearest(const BoxTreeView& tree, const BoxQuery& query,
                                     double& squared, Visit&& visit) {
  BoxEntry stack[kBoxStack];
  stack[0] = {0, tree.level_count - 1, 0};
  float bound = tree.bound_of(squared);
  for (int size = 1; size > 0;) {
    const BoxEntry entry = stack[--size];
    if (!(entry.distance < bound)) continue;
    if (entry.level == 0) {
      visit_primitives<Near>(tree, entry.index, query, squared, visit);
      bound = tree.bound_of(squared);
      continue;
    }
    Near lanes(tree.levels[entry.level][entry.index], query, bound);
    const int from = size;
    for (; lanes.near != 0; lanes.near &= lanes.near - 1) {
      const int lane = lowest_bit(lanes.near);
      const float away = lanes.distance[lane];
      int place = size++;
      for (; place > from && stack[place - 1].distance < away; --place) {
        stack[place] = stack[place - 1];
      }
      stack[place] = {away, entry.level - 1,
                      BoxNode::kWidth * entry.index + static_cast<std::uint32_t>(lane)};
    }
  }
}

// Calls take(index) for the nodes of level 0 whose boxes are nearer to the query than √squared (Å),
// in no particular order, until one call returns false. Returns whether none did.
template <class Near = NearLanes, class Take>
VDWMESH_HD inline bool for_each_near_leaf(const BoxTreeView& tree, const BoxQuery& query,
                                          double squared, Take&& take) {
  BoxEntry stack[kBoxStack];
  stack[0] = {0, tree.level_count - 1, 0};
  const float bound = tree.bound_of(squared);
  for (int size = 1; size > 0;) {
    const BoxEntry entry = stack[--size];
    if (entry.level == 0) {
      if (!take(entry.index)) return false;
      continue;
    }
    Near lanes(tree.levels[entry.level][entry.index], query, bound);
    for (; lanes.near != 0; lanes.near &= lanes.near - 1) {
      const auto lane = static_cast<std::uint32_t>(lowest_bit(lanes.near));
      stack[size++] = {lanes.distance[lane], entry.level - 1, BoxNode::kWidth * entry.index + lane};
    }
  }
  return true;
}

}  // namespace vdwmesh
