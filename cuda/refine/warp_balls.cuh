// Searches for nearest balls, for the points of a warp that lie close together. The nearest ball of
// a point is the one of least gap d - r, with d the distance to its centre and r its radius; the
// gap is negative inside. The warp gathers the balls near all its points into shared memory once.
// Each lane then searches these few balls instead of the cell list.
//
// nearest() gives the same answers as nearest_ball(), bit for bit. Gaps are computed in single
// precision first, with a bound on their error. Only the balls that this bound cannot tell apart
// are compared in double.
#pragma once

#include <cstdint>

#include "cuda/memory/ordered_bits.cuh"
#include "cuda/spheres/visit_level.cuh"
#include "refine/projection_formulas.hpp"

namespace vdwmesh {

inline constexpr std::uint32_t kNearBalls = 128;  // the most balls that a warp gathers
// The loops below take this many balls per turn; their computations overlap, as none waits for
// another.
inline constexpr std::uint32_t kAtATime = 4;

// Shared memory of one warp, 2.6 KiB. Ball k of those gathered is in slot k.
struct WarpBallsStorage {
  float4 rough[kNearBalls + kAtATime];  // centre relative to the box's origin, and radius; Å
  ListPlace place[kNearBalls];
};

// The bounding box of a warp's points, relative to an origin near them and rounded outward to
// single precision. Beside it stands the width: the largest distance at which any of the points
// asks for balls.
class PointsBox {
 public:
  // All lanes must give the same origin, which is one of the points or near them.
  __device__ explicit PointsBox(const Vec3d& origin) : origin_(origin) {}
  // Adds a point of the calling lane, which asks for balls within `wide` (Å). Until join() each
  // lane has a box of its own.
  __device__ void add(const Vec3d& p, double wide) {
    for (int axis = 0; axis < 3; ++axis) {
      const double at = p[axis] - origin_[axis];
      low_[axis] = fminf(low_[axis], __double2float_rd(at));
      high_[axis] = fmaxf(high_[axis], __double2float_ru(at));
    }
    wide_ = fmaxf(wide_, __double2float_ru(wide));
  }
  // Replaces the lanes' boxes by the box of the whole warp. All lanes must call it together, once.
  __device__ void join() {
    for (int axis = 0; axis < 3; ++axis) {
      low_[axis] = least_of_warp(low_[axis]) * 1.00001f;
      high_[axis] = largest_of_warp(high_[axis]) * 1.00001f;
    }
    wide_ = largest_of_warp(wide_) * 1.00001f;
  }
  __device__ const Vec3d& origin() const { return origin_; }
  __device__ float low(int axis) const { return low_[axis]; }
  __device__ float high(int axis) const { return high_[axis]; }
  __device__ float wide() const { return wide_; }

 private:
  Vec3d origin_;
  // The box holds the origin, so low <= 0 <= high, and the factors of join(), a little above 1,
  // widen it. Å.
  float low_[3] = {0, 0, 0}, high_[3] = {0, 0, 0}, wide_ = 0;
};

// The balls near a PointsBox, for one of two uses. Either each lane calls begin() for each of its
// points, then nearest() for it. Or all lanes call prepare_covers() once, and then
// is_on_at_most_one_ball() for their points.
class WarpBalls {
 public:
  // Gathers the balls near the box. All lanes must call it together. If the box spans too many
  // cells or there are more than kNearBalls balls, the set is incomplete: nearest() then searches
  // the cell list, and is_on_at_most_one_ball() is always false.
  __device__ WarpBalls(const CellListView& list, WarpBallsStorage& storage, const PointsBox& box);

  // Announces a new point of the lane. Between the calls of nearest() the point may move, but never
  // further than `moves` (Å) from where it is announced. Such a move changes the gap of every ball
  // by `moves` at most. So a ball that becomes the nearest has at the start a gap that exceeds the
  // least one by 2 * moves at most: this is the window. It is widened by the errors of two computed
  // gaps.
  __device__ void begin(double moves) {
    likely_ = 0;
    window_ = 2 * (1.00001f * __double2float_ru(moves) + error_bound_);
  }
  // The ball of least gap at q among those with a gap of at most `reach` (Å); ties go to the lower
  // rank. The first call after begin() must be for the announced point; it also notes the balls
  // within the window. Later calls are for places to which the point has moved, and test only the
  // noted balls. Precondition: the announced point was added to the box with a `wide` of at least
  // moves + reach.
  __device__ NearestBall nearest(const Vec3d& q, double reach);

  // Prepares is_on_at_most_one_ball(): overwrites the radii that nearest() needs, so nearest() must
  // not be called afterwards. All lanes must call it together.
  __device__ void prepare_covers();
  // Whether it is proved, in spite of rounding, that q lies in or on at most one ball, and that q
  // is further than kProjectionTolerance from every other ball. False may also mean that the proof
  // failed.
  __device__ bool is_on_at_most_one_ball(const Vec3d& q) const;

 private:
  // A point relative to the origin, in single precision.
  struct Rough {
    float x, y, z;
  };
  __device__ Rough rough(const Vec3d& q) const {
    return {static_cast<float>(q.x - origin_.x), static_cast<float>(q.y - origin_.y),
            static_cast<float>(q.z - origin_.z)};
  }
  // The gap in single precision, with an error below error_bound_. The approximate square root of
  // the hardware is faster than the exact one.
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
  // The least gap of the balls seen so far, the second least, and the slot of the ball with the
  // least. In take(), the larger of the old least gap and the new gap competes for second place.
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
  __device__ void consider(ListPlace place, const Vec3d& q, double reach, NearestBall& best) const;

  const CellListView& list_;
  WarpBallsStorage& storage_;
  Vec3d origin_;
  std::uint32_t count_ = 0;
  std::uint32_t likely_ = 0;  // bit k: later calls test slot k; no bit set: they test all slots
  float window_ = 0;          // Å, see begin()
  float error_bound_ = 0;     // Å, an upper bound of the error of gap_of()
  bool complete_ = false;     // whether all balls near the box have been gathered
};

__device__ inline WarpBalls::WarpBalls(const CellListView& list, WarpBallsStorage& storage,
                                       const PointsBox& box)
    : list_(list), storage_(storage), origin_(box.origin()) {
  // `extent` becomes the largest distance from the origin, along any axis, of the box widened by
  // `reach`.
  const float reach = box.wide();
  float extent = 0;
  Vec3d lower, upper;
  for (int axis = 0; axis < 3; ++axis) {
    extent = fmaxf(extent, fmaxf(-box.low(axis), box.high(axis)) + reach);
    lower[axis] = origin_[axis] + (static_cast<double>(box.low(axis)) - reach);
    upper[axis] = origin_[axis] + (static_cast<double>(box.high(axis)) + reach);
  }
  // A box that spans more cells than this on a level is not gathered for: its points are too far
  // apart to have many balls in common.
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
  bool full = false;  // whether there are more balls than the storage holds
  // No lane may still read the balls of an earlier set in the same storage.
  __syncwarp();
  for (int l = 0; l < list.level_count && !full; ++l) {
    const CellListView::Level& level = list.levels[l];
    visit_level_by_warp(level, level.cell_start, lower, upper, [&](ListPlace place, bool valid) {
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
        // The ball is kept if it may come within `reach` of the box. The slack of 1e-5 of all
        // lengths involved is over a hundred times their rounding (2^-24 = 6e-8).
        const float most = ball.w + reach + 1e-5f * size;
        near = !(dx * dx + dy * dy + dz * dz > most * most);
        if (near) largest = fmaxf(largest, size);
      }
      const unsigned votes = __ballot_sync(kAllLanes, near);
      const auto found = static_cast<std::uint32_t>(__popc(votes));
      full = count_ + found > kNearBalls;
      // True ends the visit.
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
  // The loops take kAtATime slots at a time. The last group is filled up with points that are too
  // far away to be nearest to, or to cover, any point.
  const unsigned lane = threadIdx.x % kWarp;
  if (lane < kAtATime) storage.rough[count_ + lane] = {1e18f, 0, 0, 0};
  __syncwarp();
  largest = largest_of_warp(largest);
  // The error of gap_of(): all lengths in it are at most largest + 3 * extent (Å), and it makes
  // about eight roundings of relative size 2^-24 = 6e-8, 5e-7 together. 4e-6 is eight times as
  // much. The constant 1e-15 covers squares that underflow: then d is below 1e-19. If error_bound_
  // < 1e10, all lengths are below 3e15, and no square overflows; otherwise the set counts as
  // incomplete.
  error_bound_ = 4e-6f * (largest + 3 * extent) + 1e-15f;
  complete_ = !full && error_bound_ < 1e10f;
}

// Replaces `best` by the ball at a list place if the ball's gap at q is at most `reach`, and less
// than that of `best`, or equal and the ball of lower rank. Computed in double, with the operations
// of nearest_ball_within().
__device__ inline void WarpBalls::consider(ListPlace place, const Vec3d& q, double reach,
                                           NearestBall& best) const {
  const double g = gap(list_.spheres[place], q);
  if (!(g <= reach)) return;
  const bool first =
      !best.found || g < best.gap || (g == best.gap && list_.rank[place] < list_.rank[best.place]);
  if (first) best = {g, place, true};
}

// The two least gaps over all slots. Notes in likely_ the balls within the window, one bit per
// slot. If there are more balls than its 32 bits, it notes none, and later calls test all slots.
// The window is measured from the least gap so far, which is not below the final one, so no ball
// within the window is left out.
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

// The two least gaps over the slots noted in likely_. left &= left - 1 removes the lowest bit.
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
  // No ball found so far.
  NearestBall best{reach, ListPlace{}, false};
  if (!(least.gap <= __double2float_ru(reach) + error_bound_)) return best;
  // Computed gaps err by at most error_bound_. So the ball that is nearest in double has a computed
  // gap of at most the least computed one plus twice that. If the second least gap is above this,
  // only one ball is left; otherwise all balls up to it are compared in double.
  const float most = least.gap + 2 * error_bound_;
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

// Replaces each radius by the square of a slightly larger one, so that is_on_at_most_one_ball() can
// compare squares. The margin is twice the error of a computed gap plus twice kProjectionTolerance,
// Å. The factors of 2 also cover the rounding of the sum and the square.
__device__ inline void WarpBalls::prepare_covers() {
  const float more = 2 * error_bound_ + 2 * static_cast<float>(kProjectionTolerance);
  for (std::uint32_t k = threadIdx.x % kWarp; k < count_; k += kWarp) {
    const float radius = storage_.rough[k].w + more;
    storage_.rough[k].w = radius * radius;
  }
  __syncwarp();
}

__device__ inline bool WarpBalls::is_on_at_most_one_ball(const Vec3d& q) const {
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
