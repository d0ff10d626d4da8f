// Divides a box into cubic bins of equal width, for searches by position.
//
// An example is the cell list of the spheres (spheres/cell_list.cpp), which stores each sphere in
// the bin of its centre and visits only the bins near a query. cubic_bins() chooses the width of
// the bins such that their number, and with it the memory of such a list, stays within a limit.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/vec3.hpp"

namespace vdwmesh {

struct Bins {
  double width;                       // Å, the edge of one bin
  std::array<std::int32_t, 3> count;  // bins along x, y and z, each at least 1
};

// Upper limit on the number of bins, whatever the caller allows: bins are numbered by int32.
inline constexpr double kMostBins = std::numeric_limits<std::int32_t>::max();

// Returns bins of width `width` that cover a box of the given extent. If these would be more than
// `most` bins in all, the bins are made wider until they are at most `most`. Along every axis the
// last bin contains the upper end of the box in its interior, so a point on that end has a bin.
// Preconditions: extent (Å) is finite and not negative, width (Å) is above 0, most is at least 1.
inline Bins cubic_bins(const Vec3d& extent, double width, double most) {
  most = std::min(most, kMostBins);
  for (;;) {
    const auto along = [&](int axis) { return std::floor(extent[axis] / width) + 1; };
    const double total = along(0) * along(1) * along(2);
    if (total <= most) {
      const auto count = [&](int axis) { return static_cast<std::int32_t>(along(axis)); };
      return {width, {count(0), count(1), count(2)}};
    }
    // The total falls about as 1 / width³, so the width has to grow by about the cube root of
    // total / most. This factor may be too small, because every count is rounded up. A factor of at
    // least 1.01 makes the loop end: a bin wider than the box is the only one, and most >= 1.
    width *= std::max(1.01, std::cbrt(total / most));
  }
}

}  // namespace vdwmesh
