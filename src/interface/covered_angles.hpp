// What caps cover of circles about one axis, as ranges of the angle. For the library's own use.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/vec3.hpp"
#include "measures/arcs/arc_cap.hpp"

namespace vdwmesh {

struct AngleRange {
  double from, to;  // rad
};

// The points x with normal · x > least, seen from an axis: the normal's part along the axis, and
// length and angle of the part across.
struct TiltedCap {
  double along, across, azimuth, least;
};
// `first`, `second` and `axis` are orthonormal; angles go from `first` towards `second`.
inline TiltedCap tilted_cap(const Vec3d& first, const Vec3d& second, const Vec3d& axis,
                            const Vec3d& normal, double least) {
  const double x = arcs::inner(first, normal), y = arcs::inner(second, normal);
  return {arcs::inner(axis, normal), std::sqrt(x * x + y * y), std::atan2(y, x), least};
}

// Ranges of one circle, angles from 0 to 2 π.
class CoveredAngles {
 public:
  static constexpr double kWhole = 2 * std::numbers::pi;

  void clear() { ranges_.clear(); }

  // Adds what a cap covers of the circle that is at this height on the axis.
  void add(const TiltedCap& cap, double height, double radius) {
    const double missing = cap.least - height * cap.along, most = radius * cap.across;
    if (missing >= most) return;
    if (missing <= -most) {
      ranges_.push_back({0, kWhole});
      return;
    }
    const double half = std::acos(missing / most);
    double from = cap.azimuth - half;
    if (from < 0) from += kWhole;
    const double to = from + 2 * half;
    ranges_.push_back({from, std::min(to, kWhole)});
    if (to > kWhole) ranges_.push_back({0, to - kWhole});
  }

  void set(const std::vector<TiltedCap>& caps, double height, double radius) {
    clear();
    for (const TiltedCap& cap : caps) add(cap, height, radius);
    join();
  }

  // Sorts the ranges, and joins those that overlap.
  void join() {
    std::ranges::sort(ranges_, {}, &AngleRange::from);
    std::size_t count = 0;
    for (const AngleRange& range : ranges_) {
      if (count > 0 && range.from <= ranges_[count - 1].to) {
        ranges_[count - 1].to = std::max(ranges_[count - 1].to, range.to);
      } else {
        ranges_[count++] = range;
      }
    }
    ranges_.resize(count);
  }

  // Calls visit(part, is_covered) for the parts of a range, in their order, after join().
  template <class Visit>
  void each_part(const AngleRange& whole, const Visit& visit) const {
    double done = whole.from;
    for (const AngleRange& range : ranges_) {
      const double from = std::clamp(range.from, done, whole.to);
      const double to = std::clamp(range.to, done, whole.to);
      if (from > done) visit(AngleRange{done, from}, false);
      if (to > from) visit(AngleRange{from, to}, true);
      done = to;
    }
    if (whole.to > done) visit(AngleRange{done, whole.to}, false);
  }

 private:
  std::vector<AngleRange> ranges_;
};

}  // namespace vdwmesh
