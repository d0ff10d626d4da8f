// The images of a fan's pieces in a plane, and which cross products are positive for certain: what
// surface/star_fans.hpp asks of them. All three corners of a triangle are judged at once, one in
// each lane.
//
// Rounding. The map is what its doubles say, with no element above 1.01. Let ε = 2^-53, and let the
// computed differences of coordinates be at most m. Images of points are then wrong by less than
// 20 ε m, differences of images, which are below 8 m, by 48 ε m, and the cross product of two of
// them by 2^11 ε m². What is positive must exceed 2^15 ε m² (kStrictly), so it is positive for the
// exact images, and for all places between these and the computed ones: the exact border can be
// moved to the computed one without an edge that turns back or by half a turn, and runs around the
// origin as often. A fan far smaller than 2^-400 or larger than 2^400 is not judged, for its
// products might be no numbers.
#pragma once

#include <cstdint>

#include "core/lanes/lane_masks.hpp"
#include "core/vec3.hpp"

namespace vdwmesh {

// What belongs to the corners of a triangle, by axis; corner k in lane k. The last lane repeats
// the first one.
struct LanePoint {
  Lanes axis[3];
};

template <class T>
VDWMESH_INLINE LanePoint at_corners(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c) {
  const auto lanes = [](T u, T v, T w) {
    const auto first = static_cast<double>(u);
    return Lanes{first, static_cast<double>(v), static_cast<double>(w), first};
  };
  return {{lanes(a.x, b.x, c.x), lanes(a.y, b.y, c.y), lanes(a.z, b.z, c.z)}};
}

// What belongs to the next corner, or to the one before.
VDWMESH_INLINE LanePoint of_next(const LanePoint& p) {
  LanePoint turned;
  for (int i = 0; i < 3; ++i) {
    turned.axis[i] = __builtin_shufflevector(p.axis[i], p.axis[i], 1, 2, 0, 1);
  }
  return turned;
}
VDWMESH_INLINE LanePoint of_previous(const LanePoint& p) {
  LanePoint turned;
  for (int i = 0; i < 3; ++i) {
    turned.axis[i] = __builtin_shufflevector(p.axis[i], p.axis[i], 2, 0, 1, 2);
  }
  return turned;
}

struct PlaneLanes {
  Lanes x, y;
};

VDWMESH_INLINE Lanes cross_of(const PlaneLanes& a, const PlaneLanes& b) {
  return a.x * b.y - a.y * b.x;
}
// Twice the area of a triangle.
VDWMESH_INLINE Lanes area_of(const PlaneLanes& a, const PlaneLanes& b, const PlaneLanes& c) {
  return cross_of({b.x - a.x, b.y - a.y}, {c.x - a.x, c.y - a.y});
}

// The map to a plane for each of three corners, and what is asked of images. The map of a direction
// (unit vector n) has the orthonormal basis of T. Duff et al., J. Comput. Graph. Tech. 6 (2017) 1.
class FanLanes {
 public:
  FanLanes(const LanePoint& corner, const LanePoint& n) : corner_(corner), most_(all_lanes(0)) {
    const Lanes sign = n.axis[2] < all_lanes(0) ? all_lanes(-1) : all_lanes(1);
    const Lanes a = all_lanes(-1) / (sign + n.axis[2]), b = n.axis[0] * n.axis[1] * a;
    first_[0] = all_lanes(1) + sign * n.axis[0] * n.axis[0] * a;
    first_[1] = sign * b;
    first_[2] = -sign * n.axis[0];
    second_[0] = b;
    second_[1] = sign + n.axis[1] * n.axis[1] * a;
    second_[2] = -n.axis[1];
  }

  // The image of a point.
  VDWMESH_INLINE PlaneLanes image(const LanePoint& p) {
    Lanes from[3];
    for (int i = 0; i < 3; ++i) {
      from[i] = p.axis[i] - corner_.axis[i];
      const Lanes size = magnitude_of(from[i]);
      most_ = size > most_ ? size : most_;
    }
    return {first_[0] * from[0] + first_[1] * from[1] + first_[2] * from[2],
            second_[0] * from[0] + second_[1] * from[1] + second_[2] * from[2]};
  }
  // A mask of the corners at which the least cross product is positive for certain. Precondition:
  // all images were taken.
  VDWMESH_INLINE std::uint32_t holds(const Lanes& least) const {
    return bits_of((least > kStrictly * most_ * most_) & (most_ > all_lanes(kSmallest)) &
                   (most_ < all_lanes(kLargest)));
  }
  // A mask of the corners at which the border from a to b crosses the positive x axis, if it turns
  // counter-clockwise by less than half a turn.
  static VDWMESH_INLINE LaneBits crosses(const PlaneLanes& a, const PlaneLanes& b) {
    return (a.y < all_lanes(0)) & (b.y >= all_lanes(0));
  }

 private:
  static constexpr double kStrictly = 0x1p-38, kSmallest = 0x1p-400, kLargest = 0x1p400;
  LanePoint corner_;
  Lanes first_[3], second_[3], most_;  // most_: the largest difference of coordinates, Å
};

}  // namespace vdwmesh
