// The search in a box tree by a warp for 32 points that are near each other, one for each lane.
//
// The warp walks through the tree once for all of its points, and visits a node if one of them may
// be nearest to something in it. All lanes read the same node, so no lane waits for the memory of
// another one, and neighbouring points visit nearly the same nodes. (The principle is that of
// packets of rays: J. Günther et al., "Realtime ray tracing on GPU with BVH-based packet
// traversal", IEEE Symposium on Interactive Ray Tracing 2007.) Points far from each other are
// searched for rightly too, but no faster than one after another.
#pragma once

#include <cstdint>

#include "analysis/distances/box_tree_view.hpp"
#include "core/host_device.hpp"
#include "cuda/memory/warp.cuh"

namespace vdwmesh::distance {

// The search stack of a warp, in shared memory.
struct WarpStack {
  BoxEntry entries[kBoxStack];
};

// The search of one warp; all lanes call each of the functions together.
class WarpSearch {
 public:
  __device__ WarpSearch(const BoxTreeView& tree, WarpStack& stack)
      : tree_(tree), stack_(stack), lane_(threadIdx.x % kWarp) {}

  // Does for the points of all lanes what visit_nearest() does for one. visit(index, near, squared)
  // is called for nodes of level 0: bit i of `near` says whether child i may be nearer to the
  // lane's point than √squared (Å). visit may lower `squared`. A lane that has no point passes a
  // negative `squared`.
  template <class Visit>
  __device__ void visit_leaves(const BoxQuery& query, double& squared, const Visit& visit) {
    float bound = bound_of(squared);
    __syncwarp();  // the stack may still be read by the search before
    if (lane_ == 0) stack_.entries[0] = {0, tree_.level_count - 1, 0};
    for (int size = 1; size > 0;) {
      __syncwarp();
      const BoxEntry entry = stack_.entries[--size];
      if (!__any_sync(kAllLanes, entry.distance < bound)) continue;
      const NearLanes lanes(tree_.levels[entry.level][entry.index], query, bound);
      if (entry.level == 0) {
        visit(entry.index, lanes.near, squared);
        bound = bound_of(squared);
      } else {
        push(entry, lanes, size);
      }
    }
  }

 private:
  __device__ float bound_of(double squared) const {
    return squared < 0 ? 0 : tree_.bound_of(squared);
  }

  // Pushes the children that are near a point, the one that is nearest to some point on top. Lane c
  // pushes child c, whose distance is the least of all points'. Distances >= 0, as integers, have
  // the order of the floats.
  __device__ void push(const BoxEntry& parent, const NearLanes& lanes, int& size) {
    const std::uint32_t near = __reduce_or_sync(kAllLanes, lanes.near);
    std::uint32_t own = 0;
#pragma unroll
    for (unsigned c = 0; c < BoxNode::kWidth; ++c) {
      const bool here = lanes.near >> c & 1;
      const std::uint32_t least =
          __reduce_min_sync(kAllLanes, here ? __float_as_uint(lanes.distance[c]) : 0xffffffffu);
      if (lane_ == c) own = least;
    }
    int below = 0;  // how many of the pushed children are farther
#pragma unroll
    for (unsigned c = 0; c < BoxNode::kWidth; ++c) {
      const std::uint32_t other = __shfl_sync(kAllLanes, own, static_cast<int>(c));
      below += (near >> c & 1) && (other > own || (other == own && c < lane_));
    }
    __syncwarp();  // all have read the parent, whose place is written now
    if (lane_ < BoxNode::kWidth && (near >> lane_ & 1)) {
      stack_.entries[size + below] = {__uint_as_float(own), parent.level - 1,
                                      BoxNode::kWidth * parent.index + lane_};
    }
    size += count_bits(near);
  }

  const BoxTreeView& tree_;
  WarpStack& stack_;
  unsigned lane_;
};

}  // namespace vdwmesh::distance
