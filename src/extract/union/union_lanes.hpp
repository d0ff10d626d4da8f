// The balls and the crossed edges of one brick as arrays (structure of arrays), so that the
// compiler vectorises the loops over them, on the CPU. NearBalls holds the balls in float32, with a
// bound on the error of what is computed from it. EdgeLanes holds one edge per lane, finds the
// balls that may touch each edge, and computes normals.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "extract/grid.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// The balls that touch a brick, in float32 and relative to its node 0. A vector register holds
// twice as many float32 numbers as doubles. Every decision in float32 allows for its rounding
// error; what is nearer to the threshold than this error is decided in double.
//
// The error of d^2 - r^2, for a spacing h and u = 2^-24: the centre of a ball that touches the
// brick has coordinates of magnitude at most D = 8 h + r, and they differ from the coordinates of
// any node by at most D. A difference of two rounded coordinates errs by up to 3 u D, its square by
// 7 u D^2, and the sum of three squares and -r^2 by 30 u D^2 = 1.8e-6 D^2. kRounding is the
// factor 1.8e-6 with some reserve.
struct NearBalls {
  static constexpr float kRounding = 2.5e-6f;
  std::vector<float> center[3];  // Å
  std::vector<float> radius;     // Å
  float largest = 0;             // largest radius, Å

  std::size_t size() const { return radius.size(); }
  void gather(const std::vector<Sphere>& balls, const Vec3d& origin);
};

inline void NearBalls::gather(const std::vector<Sphere>& balls, const Vec3d& origin) {
  largest = 0;
  for (std::vector<float>& of_axis : center) of_axis.resize(balls.size());
  radius.resize(balls.size());
  for (std::size_t k = 0; k < balls.size(); ++k) {
    for (int axis = 0; axis < 3; ++axis)
      center[axis][k] = static_cast<float>(balls[k].center[axis] - origin[axis]);
    radius[k] = static_cast<float>(balls[k].radius);
    largest = std::max(largest, radius[k]);
  }
}

// Bound on the error of d^2 - r^2 in float32, Å², for balls of at most this radius (Å) and a grid
// of this spacing (Å). The smallest normal number is added so that the bound is not 0 if the
// squares underflow.
inline float rounding_of_squares(float radius, float spacing) {
  const float extent = 8 * spacing + radius;
  return NearBalls::kRounding * extent * extent + std::numeric_limits<float>::min();
}

// The crossed edges of a brick, a lane each, in the order of their vertices. Lengths in Å.
struct EdgeLanes {
  // Room for all 3 * 512 edges. The 8 extra lanes keep the arrays from lying a multiple of a page
  // (4096 bytes) apart; equal lanes of all arrays would then compete for the same lines of the
  // cache.
  static constexpr std::size_t kMost = 3 * kBrickNodes + 8;
  template <class T>
  using Lanes = std::array<T, kMost>;

  std::size_t count = 0;
  Lanes<float> middle[3];  // middle of the edge, relative to the brick's node 0
  // position: the vertex, absolute. radial: from the centre of the vertex's sphere to the vertex.
  Lanes<double> position[3], radial[3];
  Lanes<float> normal[3];       // unit
  Lanes<SphereId> sphere;       // the vertex's atom
  Lanes<std::uint8_t> clamped;  // 1 if the vertex was clamped

  // For every edge e, overwrites bits[e]: bit k - first is set if ball k, first <= k < first + 32,
  // may touch the edge. Balls that just miss the edge may be among them; no ball that touches it is
  // missing.
  void find_touching(const NearBalls& balls, float spacing, std::size_t first,
                     std::uint32_t* bits) const;
  // Computes the normals from the radial vectors, with the operations of unit_or(). Returns how
  // many radial vectors have no direction; their normals are 0 and need a fallback.
  std::int64_t find_normals();
};

inline void EdgeLanes::find_touching(const NearBalls& balls, float spacing, std::size_t first,
                                     std::uint32_t* bits) const {
  const std::size_t last = std::min(balls.size(), first + 32);
  std::fill_n(bits, count, 0u);
  for (std::size_t k = first; k < last; ++k) {
    const float cx = balls.center[0][k], cy = balls.center[1][k], cz = balls.center[2][k];
    // A point of the edge is at most half the spacing from the edge's middle. So if the ball
    // touches the edge, the middle is at most `reach` from the ball's centre.
    const float reach = balls.radius[k] + 0.5f * spacing;
    const float reach2 = reach * reach + rounding_of_squares(reach, spacing);
    const std::uint32_t bit = 1u << (k - first);
    for (std::size_t e = 0; e < count; ++e) {
      const float dx = middle[0][e] - cx, dy = middle[1][e] - cy, dz = middle[2][e] - cz;
      bits[e] |= dx * dx + dy * dy + dz * dz > reach2 ? 0u : bit;
    }
  }
}

inline std::int64_t EdgeLanes::find_normals() {
  std::int64_t without = 0;
  for (std::size_t e = 0; e < count; ++e) {
    const Vec3d g{radial[0][e], radial[1][e], radial[2][e]};
    const double length = norm(g);
    const bool usable = length > 0 && length < 1e300;
    normal[0][e] = static_cast<float>(usable ? g.x / length : 0.0);
    normal[1][e] = static_cast<float>(usable ? g.y / length : 0.0);
    normal[2][e] = static_cast<float>(usable ? g.z / length : 0.0);
    without += usable ? 0 : 1;
  }
  return without;
}

}  // namespace vdwmesh
