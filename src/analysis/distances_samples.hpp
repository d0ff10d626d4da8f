// Sample points on the exact surface: inside exposed patches, on exposed arcs, and at corners.
//
// The points inside a patch are the exposed points of a spherical Fibonacci lattice with a random
// rotation. The caller makes one Random per sphere, with a stream number of that sphere, so the
// points do not depend on the number of threads.
#pragma once

#include <cmath>
#include <cstdint>

#include "analysis/exposed_surface.hpp"
#include "core/split_mix.hpp"

namespace vdwmesh {

// Pseudo-random numbers in [0, 1). The k-th number depends on seed, stream and k only.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream) : state_(split_mix(split_mix(seed) + stream)) {}
  double next() {
    state_ += kSplitMixStep;
    return std::ldexp(static_cast<double>(split_mix(state_) >> 11), -53);  // the upper 53 bits
  }

 private:
  std::uint64_t state_;
};

inline constexpr double kTwoPi = 6.283185307179586476925;

// A rotation of space, uniformly distributed over all rotations: a random unit quaternion after
// K. Shoemake, "Uniform random rotations", Graphics Gems III (1992).
class RandomRotation {
 public:
  explicit RandomRotation(Random& random) {
    const double split = random.next();
    const double a = kTwoPi * random.next(), b = kTwoPi * random.next();
    const double p = std::sqrt(1 - split), q = std::sqrt(split);
    vector_ = {p * std::sin(a), p * std::cos(a), q * std::sin(b)};
    scalar_ = q * std::cos(b);
  }
  // Rotates v by the unit quaternion with vector part u and scalar part w: the result is
  // v + 2 w (u × v) + 2 u × (u × v), computed with t = 2 (u × v) as v + w t + u × t.
  Vec3d operator()(const Vec3d& v) const {
    const Vec3d t = 2.0 * cross(vector_, v);
    return v + scalar_ * t + cross(vector_, t);
  }

 private:
  Vec3d vector_;   // the three imaginary parts of the unit quaternion
  double scalar_;  // its real part
};

// Calls visit(point), with the point in Å, for the exposed points of a spherical Fibonacci lattice
// (González 2010) with `density` points per Å² on the whole sphere. The number of lattice points is
// the area times the density, rounded up or down at random: adding a random number of [0, 1) before
// the cut to an integer makes its expected value exact. Small spheres thus have their share of the
// samples.
template <class Visit>
void sample_patch(const Patch& patch, double density, Random& random, Visit&& visit) {
  const double r = patch.ball.radius;
  const double wanted = 2 * kTwoPi * r * r * density;
  const auto count = static_cast<std::uint64_t>(wanted + random.next());
  const RandomRotation turn(random);
  constexpr double kInverseGoldenRatio = 0.6180339887498948482;  // 1 / golden ratio, in turns
  const std::span<const Cover> covers = patch.covers;
  for (std::uint64_t i = 0; i < count; ++i) {
    // Planes z = constant at equal distances cut the unit sphere into `count` zones of equal area.
    // Point k is in the middle of zone k, at the longitude of k · kInverseGoldenRatio turns. Whole
    // turns are subtracted first, so that the angle keeps its digits if k is large.
    const auto k = static_cast<double>(i);
    const double z = 1 - (2 * k + 1) / static_cast<double>(count);
    const double angle = kTwoPi * (k * kInverseGoldenRatio - std::floor(k * kInverseGoldenRatio));
    const double s = std::sqrt((1 - z) * (1 + z));
    const Vec3d direction = turn({s * std::cos(angle), s * std::sin(angle), z});
    if (is_exposed(covers, direction)) visit(patch.ball.center + r * direction);
  }
}

// Calls visit(point), with the point in Å, for exposed points at even distances on the circles of
// the patch, `density` points per Å, and for its corners. Two spheres share a circle and three
// share a corner; only the sphere with the smallest list place visits the shared points. The first
// point of each circle is at a random angle.
template <class Visit>
void sample_border(const Patch& patch, double density, Random& random, Visit&& visit) {
  const double r = patch.ball.radius;
  const std::span<const Cover> covers = patch.covers;
  for (std::size_t i = 0; i < patch.circles; ++i) {
    if (covers[i].place < patch.place) continue;
    const arcs::Cap& cap = covers[i].cap;
    // The circle's radius and, below, all points on it are in units of the sphere's radius.
    const double radius = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
    const arcs::Frame frame = arcs::frame_of(cap.axis);
    const auto count = static_cast<std::uint64_t>(std::ceil(kTwoPi * radius * r * density));
    const double start = random.next();
    for (std::uint64_t k = 0; k < count; ++k) {
      const double angle = kTwoPi * (static_cast<double>(k) + start) / static_cast<double>(count);
      const Vec3d direction = cap.cosine * cap.axis + radius * std::cos(angle) * frame.first +
                              radius * std::sin(angle) * frame.second;
      if (is_exposed(covers, direction, i)) visit(patch.ball.center + r * direction);
    }
  }
  for (const Corner& corner : patch.corners)
    if (corner.first) visit(patch.ball.center + r * corner.position);
}

}  // namespace vdwmesh
