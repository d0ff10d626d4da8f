// A warp gathers the balls near its points, so that each lane finds the nearest one among a few
// instead of searching the list. The answers are those of nearest_ball(), bit for bit: a single
// precision look rules balls out, what it cannot tell apart is compared in double.
#pragma once

#include <cstdint>

#include "cuda/extract/ordered_gather.cuh"
#include "refine/projection_formulas.hpp"

namespace vdwmesh {

inline constexpr std::uint32_t kNearBalls = 128;
inline constexpr std::uint32_t kAtATime = 4;  // looked at together

// Shared memory of a warp.
struct WarpBallsStorage {
  float4 rough[kNearBalls + kAtATime];  // centre relative to the origin, radius
  std::uint32_t place[kNearBalls];
};

// Maps floats to integers of the same order, and back.
__device__ inline int ordered(float f) {
  const int bits = __float_as_int(f);
  return bits ^ ((bits >> 31) & 0x7fffffff);
}
__device__ inline float from_ordered(int bits) {
  return __int_as_float(bits ^ ((bits >> 31) & 0x7fffffff));
}

// The box of a warp's points, in single precision relative to one of them, rounded outward.
class WarpBox {
 public:
  // Called by all lanes with the same origin, which is one of the points or near them.
  __device__ explicit WarpBox(const Vec3d& origin) : origin_(origin) {}
  // A point of the lane, from which balls within `wide` (Å) are wanted.
  __device__ void add(const Vec3d& p, double wide) {
    for (int axis = 0; axis < 3; ++axis) {
      const double at = p[axis] - origin_[axis];
      low_[axis] = fminf(low_[axis], __double2float_rd(at));
      high_[axis] = fmaxf(high_[axis], __double2float_ru(at));
    }
    wide_ = fmaxf(wide_, __double2float_ru(wide));
  }
  // Called by all lanes, once: makes the boxes of the lanes that of the warp.
  __device__ void join() {
    for (int axis = 0; axis < 3; ++axis) {
      low_[axis] = from_ordered(__reduce_min_sync(kAllLanes, ordered(low_[axis]))) * 1.00001f;
      high_[axis] = from_ordered(__reduce_max_sync(kAllLanes, ordered(high_[axis]))) * 1.00001f;
    }
    wide_ = from_ordered(__reduce_max_sync(kAllLanes, ordered(wide_))) * 1.00001f;
  }
  __device__ const Vec3d& origin() const { return origin_; }
  __device__ float low(int axis) const { return low_[axis]; }
  __device__ float high(int axis) const { return high_[axis]; }
  __device__ float wide() const { return wide_; }

 private:
  Vec3d origin_;
  // The origin is in the box, so that the factors of join() widen it.
  float low_[3] = {0, 0, 0}, high_[3] = {0, 0, 0}, wide_ = 0;
};

class WarpBalls {
 public:
  // Called by all lanes: gathers the balls near the box. Where they are too many or too far apart
  // there are none, and nearest() searches the list.
  __device__ WarpBalls(const CellListView& list, WarpBallsStorage& storage, const WarpBox& box);

  // Before the calls of nearest() for a point that is to move at most `moves` (Å).
  __device__ void begin(double moves) {
    likely_ = 0;
    window_ = 2 * (1.00001f * __double2float_ru(moves) + doubt_);
  }
  // The ball of least d - r among those within `reach` of q, ties by rank; moves + reach is within
  // what was gathered. The first call is for the point itself; later ones look at the balls alone
  // that can be nearest after the move.
  __device__ NearestBall nearest(const Vec3d& q, double reach);

  // Called by all lanes: from now on only is_alone() may be asked.
  __device__ void prepare_covers();
  // Whether q lies in or on one ball at most, by a margin that rounding does not bridge. False
  // where that is not known.
  __device__ bool is_alone(const Vec3d& q) const;

 private:
  struct Rough {
    float x, y, z;
  };
  __device__ Rough rough(const Vec3d& q) const {
    return {static_cast<float>(q.x - origin_.x), static_cast<float>(q.y - origin_.y),
            static_cast<float>(q.z - origin_.z)};
  }
  __device__ static float gap_of(const Rough& q, const float4& ball) {
    const float dx = q.x - ball.x, dy = q.y - ball.y, dz = q.z - ball.z;
    float distance;
    const float square = fmaf(dx, dx, fmaf(dy, dy, dz * dz));
    asm("sqrt.approx.f32 %0, %1;" : "=f"(distance) : "f"(square));
    return distance - ball.w;
  }
  __device__ std::uint32_t padded_count() const {
    return (count_ + kAtATime - 1) / kAtATime * kAtATime;
  }
  struct Least {
    float gap, second;
    std::uint32_t slot;
  };
  __device__ static void take(Least& least, float g, std::uint32_t slot) {
    least.second = fminf(least.second, fmaxf(least.gap, g));
    least.slot = g < least.gap ? slot : least.slot;
    least.gap = fminf(least.gap, g);
  }
  __device__ Least least_of_all(const Rough& at);
  __device__ Least least_of_likely(const Rough& at) const;
  __device__ void consider(std::uint32_t place, const Vec3d& q, double reach,
                           NearestBall& best) const;

  const CellListView& list_;
  WarpBallsStorage& storage_;
  Vec3d origin_;
  std::uint32_t count_ = 0;
  std::uint32_t likely_ = 0;  // slots that later calls look at; 0: all
  float window_ = 0;          // Å, beyond the least gap
  float doubt_ = 0;           // Å, more than the error of gap_of()
  bool complete_ = false;
};

__device__ inline WarpBalls::WarpBalls(const CellListView& list, WarpBallsStorage& storage,
                                       const WarpBox& box)
    : list_(list), storage_(storage), origin_(box.origin()) {
  const float reach = box.wide();
  float extent = 0;
  Vec3d lower, upper;
  for (int axis = 0; axis < 3; ++axis) {
    extent = fmaxf(extent, fmaxf(-box.low(axis), box.high(axis)) + reach);
    lower[axis] = origin_[axis] + (static_cast<double>(box.low(axis)) - reach);
    upper[axis] = origin_[axis] + (static_cast<double>(box.high(axis)) + reach);
  }
  constexpr double most_cells = 16;
  for (int l = 0; l < list.level_count; ++l) {
    const CellListView::Level& level = list.levels[l];
    const double most = most_cells * level.cell_size;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(upper[axis] - lower[axis] + 2 * level.reach < most)) return;
    }
  }
  const unsigned below = (1u << (threadIdx.x % kWarp)) - 1;
  float largest = 0;
  bool full = false;
  __syncwarp();
  for (int l = 0; l < list.level_count && !full; ++l) {
    visit_level_by_warp(list.levels[l], lower, upper, [&](std::uint32_t place, bool valid) {
      float4 ball{0, 0, 0, 0};
      bool near = false;
      if (valid) {
        const Sphere& s = list.spheres[place];
        ball = {static_cast<float>(s.center.x - origin_.x),
                static_cast<float>(s.center.y - origin_.y),
                static_cast<float>(s.center.z - origin_.z), static_cast<float>(s.radius)};
        const float dx = fmaxf(0.0f, fmaxf(box.low(0) - ball.x, ball.x - box.high(0)));
        const float dy = fmaxf(0.0f, fmaxf(box.low(1) - ball.y, ball.y - box.high(1)));
        const float dz = fmaxf(0.0f, fmaxf(box.low(2) - ball.z, ball.z - box.high(2)));
        const float size = fabsf(ball.x) + fabsf(ball.y) + fabsf(ball.z) + ball.w;
        const float most = ball.w + reach + 1e-5f * size;
        near = !(dx * dx + dy * dy + dz * dz > most * most);
        if (near) largest = fmaxf(largest, size);
      }
      const unsigned votes = __ballot_sync(kAllLanes, near);
      const auto found = static_cast<std::uint32_t>(__popc(votes));
      full = count_ + found > kNearBalls;
      if (full) return true;
      const std::uint32_t slot = count_ + static_cast<std::uint32_t>(__popc(votes & below));
      if (near) {
        storage.rough[slot] = ball;
        storage.place[slot] = place;
      }
      count_ += found;
      return false;
    });
  }
  // Balls too far to be nearest fill the last group.
  const unsigned lane = threadIdx.x % kWarp;
  if (lane < kAtATime) storage.rough[count_ + lane] = {1e18f, 0, 0, 0};
  __syncwarp();
  largest = from_ordered(__reduce_max_sync(kAllLanes, ordered(largest)));
  // Squares of what is accepted neither overflow nor lose all their digits.
  doubt_ = 4e-6f * (largest + 3 * extent) + 1e-15f;
  complete_ = !full && doubt_ < 1e10f;
}

__device__ inline void WarpBalls::consider(std::uint32_t place, const Vec3d& q, double reach,
                                           NearestBall& best) const {
  const double g = gap(list_.spheres[place], q);
  if (!(g <= reach)) return;
  const bool first =
      !best.found || g < best.gap || (g == best.gap && list_.rank[place] < list_.rank[best.place]);
  if (first) best = {g, place, true};
}

// Notes what can be nearest after a move of `moves`: gaps differ by twice that at most.
__device__ inline WarpBalls::Least WarpBalls::least_of_all(const Rough& at) {
  Least least{INFINITY, INFINITY, 0};
  std::uint32_t likely = 0;
  const std::uint32_t end = padded_count();
  for (std::uint32_t first = 0; first < end; first += kAtATime) {
    float g[kAtATime];
    for (std::uint32_t i = 0; i < kAtATime; ++i) g[i] = gap_of(at, storage_.rough[first + i]);
    std::uint32_t bits = 0;
    for (std::uint32_t i = 0; i < kAtATime; ++i) {
      take(least, g[i], first + i);
      bits |= g[i] <= least.gap + window_ ? 1u << i : 0u;
    }
    likely |= bits << (first % 32);
  }
  likely_ = count_ <= 32 ? likely : 0;
  return least;
}

__device__ inline WarpBalls::Least WarpBalls::least_of_likely(const Rough& at) const {
  Least least{INFINITY, INFINITY, 0};
  for (std::uint32_t left = likely_; left != 0; left &= left - 1) {
    const auto slot = static_cast<std::uint32_t>(__ffs(static_cast<int>(left)) - 1);
    take(least, gap_of(at, storage_.rough[slot]), slot);
  }
  return least;
}

__device__ inline NearestBall WarpBalls::nearest(const Vec3d& q, double reach) {
  if (!complete_) return nearest_ball(list_, q, kProjectionTolerance, reach);
  const Rough at = rough(q);
  const Least least = likely_ != 0 ? least_of_likely(at) : least_of_all(at);
  NearestBall best{reach, 0, false};
  if (!(least.gap <= __double2float_ru(reach) + doubt_)) return best;
  const float most = least.gap + 2 * doubt_;
  if (least.second > most) {
    consider(storage_.place[least.slot], q, reach, best);
    return best;
  }
  for (std::uint32_t k = 0; k < count_; ++k) {
    if (likely_ != 0 && (likely_ >> k & 1) == 0) continue;
    if (gap_of(at, storage_.rough[k]) <= most) consider(storage_.place[k], q, reach, best);
  }
  return best;
}

// Radii become squares of a little more than them.
__device__ inline void WarpBalls::prepare_covers() {
  const float more = 2 * doubt_ + 2 * static_cast<float>(kProjectionTolerance);
  for (std::uint32_t k = threadIdx.x % kWarp; k < count_; k += kWarp) {
    const float radius = storage_.rough[k].w + more;
    storage_.rough[k].w = radius * radius;
  }
  __syncwarp();
}

__device__ inline bool WarpBalls::is_alone(const Vec3d& q) const {
  const Rough at = rough(q);
  const std::uint32_t end = padded_count();
  unsigned covers = 0;
  for (std::uint32_t first = 0; first < end; first += kAtATime) {
    for (std::uint32_t i = 0; i < kAtATime; ++i) {
      const float4 ball = storage_.rough[first + i];
      const float dx = at.x - ball.x, dy = at.y - ball.y, dz = at.z - ball.z;
      covers += fmaf(dx, dx, fmaf(dy, dy, dz * dz)) <= ball.w ? 1 : 0;
    }
  }
  return complete_ && covers <= 1;
}

}  // namespace vdwmesh
