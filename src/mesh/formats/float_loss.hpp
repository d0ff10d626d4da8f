// Rounds coordinates to float32 for the formats that store nothing wider (STL, GLB), and measures
// how far they move by that.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "core/vec3.hpp"

namespace vdwmesh::formats {

// The writers warn of displacements above this (Å, per coordinate).
inline constexpr double kNoticeableLoss = 1e-4;

class FloatLoss {
 public:
  // `scale` is the length in the file for 1 Å.
  explicit FloatLoss(double scale) : scale_(scale) {}

  // Returns p rounded to float. A coordinate beyond the range of float becomes infinite, which
  // finish() reports.
  Vec3f round(const Vec3d& p) {
    const Vec3f rounded = cast<float>(p);
    for (int axis = 0; axis < 3; ++axis)
      largest_ = std::max(largest_, std::abs(p[axis] - static_cast<double>(rounded[axis])));
    return rounded;
  }
  // Call it once, after the last round(). Adds a warning if a coordinate moved noticeably. Throws
  // InvalidInput if one was beyond the range of float. `format` is the format's name for people.
  void finish(const char* format, std::vector<std::string>& warnings) const {
    if (largest_ > std::numeric_limits<double>::max())
      throw InvalidInput(fmt::format("coordinates are beyond the range of {}'s float32", format));
    if (largest_ > kNoticeableLoss * scale_)
      warnings.push_back(
          fmt::format("{} keeps coordinates as float32: they moved by up to {:.1e} Å; PLY keeps "
                      "all digits",
                      format, largest_ / scale_));
  }

 private:
  double scale_;
  double largest_ = 0;  // as in the file, over all coordinates so far; infinite after an overflow
};

}  // namespace vdwmesh::formats
