// What derivatives of area and volume by the centres and radii of balls satisfy, whatever the set:
// translation, rotation and scaling, Σ ∂ = 0, Σ x × ∂ = 0, Σ x·∂x + r ∂r = 2 A or 3 V.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/vec3.hpp"
#include "measures/union_gradients.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh::testing {

// A sum that rounding keeps from 0, beside the sum of the sizes of its terms.
struct Balance {
  double sum = 0, size = 0;
  void add(double term) {
    sum += term;
    size += std::abs(term);
  }
  double error() const { return std::abs(sum) / (1e-300 + size); }
};

class GradientIdentities {
 public:
  // Places count from the origin, so that far sets lose no digits.
  explicit GradientIdentities(const Vec3d& origin) : origin_(origin) {}

  void add(const Sphere& ball, const BallGradient& d) {
    const Vec3d x = ball.center - origin_;
    for (int axis = 0; axis < 3; ++axis) {
      area_sum_.add(d.area_center[axis]);
      volume_sum_.add(d.volume_center[axis]);
      area_torque_.add(cross(x, d.area_center)[axis]);
      volume_torque_.add(cross(x, d.volume_center)[axis]);
      add_scaling(x[axis] * d.area_center[axis], x[axis] * d.volume_center[axis]);
      reach_ = std::max(reach_, std::abs(x[axis]));
    }
    add_scaling(ball.radius * d.area_radius, ball.radius * d.volume_radius);
  }
  // Other terms of scaling: -2 A and -3 V, and those of other lengths.
  void add_scaling(double area, double volume) {
    area_scale_.add(area);
    volume_scale_.add(volume);
  }

  // `error`: of a term, as a share of its size.
  void expect_within(double error) const {
    EXPECT_LE(std::abs(area_sum_.sum), error * (1 + area_sum_.size));
    EXPECT_LE(std::abs(volume_sum_.sum), error * (1 + volume_sum_.size));
    EXPECT_LE(std::abs(area_torque_.sum), error * (1 + reach_) * (1 + area_sum_.size));
    EXPECT_LE(std::abs(volume_torque_.sum), error * (1 + reach_) * (1 + volume_sum_.size));
    EXPECT_LE(std::abs(area_scale_.sum), error * (1 + area_scale_.size));
    EXPECT_LE(std::abs(volume_scale_.sum), error * (1 + volume_scale_.size));
  }

 private:
  Vec3d origin_;
  Balance area_sum_, volume_sum_, area_torque_, volume_torque_, area_scale_, volume_scale_;
  double reach_ = 0;
};

}  // namespace vdwmesh::testing
