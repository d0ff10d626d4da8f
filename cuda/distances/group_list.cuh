// Lists what a group of points may be near to: a warp walks through a box tree once with the box
// around the points of some of its lanes.
//
// A walk for one lane's point alone measures eight boxes a node, one after another. Here the lanes
// share the work: eight of them take a node, one for each child, so a step expands four nodes. The
// walk goes from level to level and writes down all nodes of a level, so it needs no order and no
// stack. It pays where points are close together, as consecutive samples along a curve through
// space: then most of what is near the group is near each of its points.
#pragma once

#include <cstdint>

#include "analysis/distances/box_tree_view.hpp"
#include "cuda/memory/warp.cuh"

namespace vdwmesh::distance {

// The shared memory of a list and of the one it is made from: 1 KB.
struct GroupRoom {
  static constexpr unsigned kSize = 128;
  std::uint32_t places[2][kSize];
};

// The places of nodes in their level, or of primitives in the tree's order. Every lane has the
// same.
class GroupList {
 public:
  static constexpr unsigned kTooMany = GroupRoom::kSize + 1;

  __device__ explicit GroupList(GroupRoom& room) : room_(room) {}

  // Lists the children of nodes of the level `last`: primitives if it is 0, nodes of level 0 if it
  // is 1. Those are listed whose boxes are nearer than the bound (of squared scaled distances) to
  // the box around the queries of the lanes that are `taken`. Returns how many, or kTooMany. No box
  // is missed that is near one of the queries: the sides of the box around them are their own
  // numbers, and kBoxMargin is enough for any rounded numbers (BoxSides). All lanes call it
  // together. At least one lane must be taken.
  __device__ unsigned fill(const BoxTreeView& tree, const BoxQuery& own, bool taken, float bound,
                           int last) {
    const BoxQuery box = box_around(own, taken);
    const unsigned lane = threadIdx.x % kWarp, child = lane % BoxNode::kWidth;
    __syncwarp();
    if (lane == 0) room_.places[0][0] = 0;
    unsigned count = 1;
    now_ = 0;
    for (int level = tree.level_count - 1; level >= last; --level) {
      const BoxNode* const nodes = tree.levels[level];
      unsigned found = 0;
      __syncwarp();
      for (unsigned first = 0; first < count; first += kWarp / BoxNode::kWidth) {
        const unsigned entry = first + lane / BoxNode::kWidth;
        bool near = false;
        std::uint32_t place = 0;
        if (entry < count) {
          const std::uint32_t index = room_.places[now_][entry];
          const BoxNode& node = nodes[index];
          place = BoxNode::kWidth * index + child;
          near = child < node.count &&
                 BoxSides(node, box).squared_distance(node, static_cast<int>(child)) < bound;
        }
        const unsigned nears = __ballot_sync(kAllLanes, near);
        const unsigned to = found + bits_below(nears, lane);
        if (near && to < GroupRoom::kSize) room_.places[1 - now_][to] = place;
        found += static_cast<unsigned>(count_bits(nears));
        if (found > GroupRoom::kSize) return kTooMany;
      }
      count = found;
      now_ = 1 - now_;
    }
    __syncwarp();
    return count;
  }
  __device__ std::uint32_t operator[](unsigned i) const { return room_.places[now_][i]; }

 private:
  __device__ static float least(float x) {
    return joined_by_warp(x, [](float a, float b) { return fminf(a, b); });
  }
  __device__ static BoxQuery box_around(const BoxQuery& own, bool taken) {
    constexpr float kFar = 4;  // scaled coordinates are in [-1, 1]
    BoxQuery box;
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] = least(taken ? own.lower[axis] : kFar);
      box.upper[axis] = -least(taken ? -own.upper[axis] : kFar);
    }
    return box;
  }

  GroupRoom& room_;
  unsigned now_ = 0;  // which half of the room has the list
};

// Calls search(lanes), a bit for each, for ranges of lanes that together are all `open` ones; the
// mask has the open ones of the range. search returns false if they have too many near nodes; then
// it is called for the halves, and ranges of one lane are given up. Returns the lanes given up. All
// lanes call it together.
template <class Search>
__device__ unsigned for_each_range(unsigned open, const Search& search) {
  unsigned given_up = 0;
  for (unsigned first = 0, size = kWarp; first < kWarp;) {
    const unsigned lanes = open & (size == kWarp ? kAllLanes : (1u << size) - 1) << first;
    const bool done = lanes == 0 || search(lanes);
    if (!done && size > 1) {
      size /= 2;
      continue;
    }
    if (!done) given_up |= lanes;
    first += size;
    size = first & (0 - first);  // the largest range that may begin here
  }
  return given_up;
}

}  // namespace vdwmesh::distance
