// A warp gathers the spheres near a box in list order, as visit_near_box() visits them on the CPU,
// so that sums over them have the same bits.
#pragma once

#include <cstdint>

#include "cuda/extract/bricks/extract_stages.cuh"
#include "cuda/spheres/visit_level.cuh"

namespace vdwmesh {

// A box relative to RoughSpheres::origin, Å.
struct RoughBox {
  float lower[3], upper[3];
};

__device__ inline RoughBox rough_box(const Vec3d& origin, const Vec3d& lower, const Vec3d& upper) {
  RoughBox box{};
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = static_cast<float>(lower[axis] - origin[axis]);
    box.upper[axis] = static_cast<float>(upper[axis] - origin[axis]);
  }
  return box;
}

// Whether a sphere of RoughSpheres may touch the box. One-sided: true for every sphere whose reach
// touches the box, and for some that just miss it.
__device__ inline bool may_reach(const RoughBox& box, const float4& sphere) {
  const float x = fmaxf(fmaxf(box.lower[0] - sphere.x, sphere.x - box.upper[0]), 0.0f);
  const float y = fmaxf(fmaxf(box.lower[1] - sphere.y, sphere.y - box.upper[1]), 0.0f);
  const float z = fmaxf(fmaxf(box.lower[2] - sphere.z, sphere.z - box.upper[2]), 0.0f);
  return fmaf(x, x, fmaf(y, y, z * z)) <= sphere.w * sphere.w;
}

// Collects, by one warp, the list places of the spheres that may reach a box, in list order, and
// hands them over in batches of `size`; the last batch has the rest. For each batch, batch(count)
// is called on all lanes, with the list places in waiting[0 .. count); the warp is synchronised
// before and after. If batch() returns true, on all lanes alike, the gathering ends. Some spheres
// of a batch do not reach the box; they contribute 0 there. One vote may add 32 places to up to
// size - 1 waiting ones, so `waiting` has size + kWarp entries. Returns how many places batch() has
// taken.
template <class Batch>
__device__ std::uint32_t gather_by_warp(const FieldContext& f, const Vec3d& lower,
                                        const Vec3d& upper, ListPlace* waiting, std::uint32_t size,
                                        Batch&& batch) {
  const CellListView& list = f.list;
  const RoughBox box = rough_box(f.rough.origin, lower, upper);
  const unsigned lane = threadIdx.x % kWarp;
  std::uint32_t count = 0, met = 0;
  bool done = false;
  // Calls batch() for the first places, and moves the others (fewer than 32) to the front.
  const auto hand_over = [&](std::uint32_t first) {
    __syncwarp();
    done = batch(first);
    __syncwarp();
    count -= first;
    met += first;
    const ListPlace next = lane < count ? waiting[first + lane] : ListPlace{};
    __syncwarp();
    if (lane < count) waiting[lane] = next;
    __syncwarp();
  };
  for (int l = 0; l < list.level_count && !done; ++l) {
    const CellListView::Level& level = list.levels[l];
    visit_level_by_warp(level, level.cell_start, lower, upper, [&](ListPlace place, bool valid) {
      const bool kept = valid && may_reach(box, f.rough.spheres[place]);
      const unsigned votes = __ballot_sync(kAllLanes, kept);
      // Compaction: each kept place goes behind those of the lower lanes.
      if (kept) waiting[count + bits_below(votes, lane)] = place;
      count += static_cast<std::uint32_t>(__popc(votes));
      while (count >= size && !done) hand_over(size);
      return done;  // true ends the visit and, above, the loop
    });
  }
  if (count > 0 && !done) hand_over(count);
  return met;
}

}  // namespace vdwmesh
