// What coordinates lose on their way into a format of float32.
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

inline constexpr double kNoticeableLoss = 1e-4;  // Å

class FloatLoss {
 public:
  // Throws InvalidInput for a coordinate beyond the range of float.
  Vec3f round(const Vec3d& p) {
    const Vec3f rounded = cast<float>(p);
    for (int axis = 0; axis < 3; ++axis)
      largest_ = std::max(largest_, std::abs(p[axis] - static_cast<double>(rounded[axis])));
    return rounded;
  }
  void finish(const char* format, std::vector<std::string>& warnings) const {
    if (largest_ > std::numeric_limits<double>::max())
      throw InvalidInput(fmt::format("coordinates are beyond the range of {}'s float32", format));
    if (largest_ > kNoticeableLoss)
      warnings.push_back(
          fmt::format("{} keeps coordinates as float32: they moved by up to {:.1e} Å; PLY keeps "
                      "all digits",
                      format, largest_));
  }

 private:
  double largest_ = 0;
};

}  // namespace vdwmesh::formats
