// Cubic bins over a box, for searching by place.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/vec3.hpp"

namespace vdwmesh {

struct Bins {
  double width;  // Å
  std::array<std::int32_t, 3> count;
};

// Most bins that are made, whatever is asked for: int32 numbers them.
inline constexpr double kMostBins = std::numeric_limits<std::int32_t>::max();

// Bins of the width wished, or as much wider as makes them at most `most` in all; one bin reaches
// over the end of the box. Precondition: extent (Å) finite and not negative, width (Å) above 0,
// most at least 1.
inline Bins cubic_bins(const Vec3d& extent, double width, double most) {
  most = std::min(most, kMostBins);
  for (;;) {
    const auto along = [&](int axis) { return std::floor(extent[axis] / width) + 1; };
    const double total = along(0) * along(1) * along(2);
    if (total <= most) {
      const auto count = [&](int axis) { return static_cast<std::int32_t>(along(axis)); };
      return {width, {count(0), count(1), count(2)}};
    }
    width *= std::max(1.01, std::cbrt(total / most));
  }
}

}  // namespace vdwmesh
