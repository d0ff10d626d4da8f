// Which points of a sphere keep clear of the covered caps beside a patch, so that they do not make
// flat triangles with the pieces of its arcs. For host and device.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "arrangement/mesher/patch_boundary.hpp"
#include "arrangement/mesher/patch_memory.hpp"
#include "arrangement/sine_cosine.hpp"

namespace vdwmesh {

template <class Memory>
class CapMargins {
 public:
  // `margin`: an angle, rad. Precondition: there is a cap. `scratch` is for the bounds.
  //
  // The cosine of a cap's angular radius with the margin is that of a sum. If the sum is more than
  // half a turn, so that they cover the whole sphere, the bound of -2 admits no point.
  VDWMESH_HD CapMargins(std::span<const CoveredCap> caps, double margin,
                        typename Memory::template Array<double>& scratch)
      : caps_(caps), bounds_(scratch) {
    const SineCosine of_margin = sine_cosine(margin);
    bounds_.clear();
    for (const CoveredCap& cap : caps) {
      const double c = std::min(std::max(cap.cosine, -1.0), 1.0);
      const double sum = c * of_margin.cosine - std::sqrt((1 - c) * (1 + c)) * of_margin.sine;
      bounds_.push_back(c > -of_margin.cosine ? sum : -2);
    }
  }

  // Whether one cap with its margin covers all points that are up to the angle `radius` (rad) from
  // a point. Not all that are covered are found: rounding has 1e-7 rad of room.
  bool covers(const Vec3d& center, double radius) const {
    constexpr double kRoom = 1e-7;
    for (std::size_t i = 0; i < bounds_.size(); ++i) {
      const double apart = 2 * std::asin(std::min(1.0, norm(center - caps_[i].axis) / 2));
      if (bounds_[i] < -1 || apart + radius + kRoom < std::acos(std::min(bounds_[i], 1.0)))
        return true;
    }
    return false;
  }

  // Begins with the cap that the point before was too near to: mostly this one is, too.
  VDWMESH_HD bool is_clear(const Vec3d& u) {
    const auto is_near = [&](std::size_t cap) {
      const bool is = !(dot(u, caps_[cap].axis) <= bounds_[cap]);
      if (is) last_ = cap;
      return is;
    };
    return !is_near(last_) && !holds_for_any<Memory>(bounds_.size(), is_near);
  }

 private:
  std::span<const CoveredCap> caps_;
  typename Memory::template Array<double>& bounds_;
  std::size_t last_ = 0;
};

}  // namespace vdwmesh
