// Evenly spread points on a sphere, and the random numbers that place samples, for host and device.
//
// Host and device compute the same bits: no function of the mathematical library is used whose
// results may differ.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"
#include "core/order/split_mix.hpp"
#include "core/vec3.hpp"

namespace vdwmesh {

// Pseudo-random numbers in [0, 1). The k-th number depends on seed, stream and k only.
class Random {
 public:
  VDWMESH_HD Random(std::uint64_t seed, std::uint64_t stream)
      : state_(split_mix(split_mix(seed) + stream)) {}
  VDWMESH_HD double next() {
    state_ += kSplitMixStep;
    return static_cast<double>(split_mix(state_) >> 11) * 0x1p-53;  // the upper 53 bits
  }

 private:
  std::uint64_t state_;
};

inline constexpr double kTwoPi = 6.283185307179586476925;

struct CirclePoint {
  double cosine, sine;
};

// Returns the point of the unit circle at an angle of `turns` whole turns, 0 <= turns < 1. The
// angle is reduced to a multiple of a quarter turn and a rest x of at most an eighth, |x| <= π/4.
// The Taylor series of both functions end where the next term is below 1e-17.
VDWMESH_HD inline CirclePoint point_of_circle(double turns) {
  const double quarter = std::floor(4 * turns + 0.5);
  const double x = kTwoPi * (turns - 0.25 * quarter), y = x * x;
  double sine = 1.0 / 355687428096000;  // 1 / 17!
  sine = sine * y - 1.0 / 1307674368000;
  sine = sine * y + 1.0 / 6227020800;
  sine = sine * y - 1.0 / 39916800;
  sine = sine * y + 1.0 / 362880;
  sine = sine * y - 1.0 / 5040;
  sine = sine * y + 1.0 / 120;
  sine = sine * y - 1.0 / 6;
  sine = x + x * y * sine;
  double cosine = 1.0 / 20922789888000;  // 1 / 16!
  cosine = cosine * y - 1.0 / 87178291200;
  cosine = cosine * y + 1.0 / 479001600;
  cosine = cosine * y - 1.0 / 3628800;
  cosine = cosine * y + 1.0 / 40320;
  cosine = cosine * y - 1.0 / 720;
  cosine = cosine * y + 1.0 / 24;
  cosine = cosine * y - 0.5;
  cosine = 1 + y * cosine;
  // A quarter turn maps (c, s) to (-s, c). `quarter` is 0, 1, 2, 3 or 4.
  const bool odd = quarter == 1 || quarter == 3;
  const double c = odd ? sine : cosine, s = odd ? cosine : sine;
  return {quarter == 1 || quarter == 2 ? -c : c, quarter == 2 || quarter == 3 ? -s : s};
}

// A rotation of space, uniformly distributed over all rotations: a random unit quaternion after
// K. Shoemake, "Uniform random rotations", Graphics Gems III (1992).
class RandomRotation {
 public:
  VDWMESH_HD explicit RandomRotation(Random& random) {
    const double split = random.next();
    const double p = std::sqrt(1 - split), q = std::sqrt(split);
    const CirclePoint a = point_of_circle(random.next()), b = point_of_circle(random.next());
    vector_ = {p * a.sine, p * a.cosine, q * b.sine};
    scalar_ = q * b.cosine;
  }
  // Rotates v by the unit quaternion with vector part u and scalar part w: the result is
  // v + 2 w (u × v) + 2 u × (u × v), computed with t = 2 (u × v) as v + w t + u × t.
  VDWMESH_HD Vec3d operator()(const Vec3d& v) const {
    const Vec3d t = 2.0 * cross(vector_, v);
    return v + scalar_ * t + cross(vector_, t);
  }

 private:
  Vec3d vector_;   // the three imaginary parts of the unit quaternion
  double scalar_;  // its real part
};

// A spherical Fibonacci lattice (Á. González, Math. Geosci. 42 (2010) 49) with a random rotation.
//
// Planes z = constant at equal distances cut the unit sphere into size() zones of equal area. Point
// k is in the middle of zone k, at the longitude of k turns divided by the golden ratio. Points k
// and k + 1 are thus far from each other. For a search that starts from the result of the point
// before, at() numbers the points along a walk instead: the points k, k + F, k + 2 F, … with F a
// Fibonacci number near 1.2 √size() follow each other at about the least distance, from pole to
// pole. The walk takes these columns k = 0, 1, … F - 1 in turn, every second one backwards.
class SphereLattice {
 public:
  VDWMESH_HD SphereLattice(std::uint64_t size, Random& random) : size_(size), turn_(random) {
    std::uint64_t next = 2;
    while (4 * next * next <= 9 * size) {
      const std::uint64_t sum = columns_ + next;
      columns_ = next;
      next = sum;
    }
    short_ = size / columns_;
    long_columns_ = size % columns_;
  }
  VDWMESH_HD std::uint64_t size() const { return size_; }

  // Returns the number k of the point that is `step` steps along the walk. The first columns have
  // one point more than the others.
  VDWMESH_HD std::uint64_t at(std::uint64_t step) const {
    const std::uint64_t in_long = long_columns_ * (short_ + 1);
    const bool is_long = step < in_long;
    const std::uint64_t length = is_long ? short_ + 1 : short_;
    const std::uint64_t rest = is_long ? step : step - in_long;
    const std::uint64_t column = rest / length + (is_long ? 0 : long_columns_);
    const std::uint64_t row = rest % length;
    return column + columns_ * (column % 2 == 0 ? row : length - 1 - row);
  }

  // Returns the point with this number k, a unit vector. Whole turns are subtracted from the
  // longitude first, so that the angle keeps its digits if k is large.
  VDWMESH_HD Vec3d point(double number) const {
    constexpr double kInverseGoldenRatio = 0.6180339887498948482;
    const double z = 1 - (2 * number + 1) / static_cast<double>(size_);
    const double turns = number * kInverseGoldenRatio;
    const CirclePoint longitude = point_of_circle(turns - std::floor(turns));
    const double s = std::sqrt((1 - z) * (1 + z));
    return turn_({s * longitude.cosine, s * longitude.sine, z});
  }

 private:
  std::uint64_t size_, columns_ = 1, short_, long_columns_;
  RandomRotation turn_;
};

}  // namespace vdwmesh
