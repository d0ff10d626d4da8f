// The balls and the crossed edges of one brick, all lanes at once. CPU.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "extract/bricks/brick_geometry.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// The balls that touch a brick in float32, from its node 0, so that twice the lanes fit. What they
// decide, they decide with room for their rounding; the rest is for double precision.
//
// Coordinates and their differences are at most D = 8 h + r, differences of rounded coordinates off
// by 3 u D (u = 2^-24), their squares by 7 u D^2, the sum of three and -r^2 by 30 u D^2 = 1.8e-6
// D^2.
struct NearBalls {
  static constexpr float kRounding = 2.5e-6f;
  std::vector<float> center[3];  // Å
  std::vector<float> radius;     // Å
  float largest = 0;             // Å

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

// What the squares above are off by at most, Å².
inline float rounding_of_squares(float radius, float spacing) {
  const float extent = 8 * spacing + radius;
  return NearBalls::kRounding * extent * extent + std::numeric_limits<float>::min();
}

// The crossed edges of a brick, a lane each, in the order of their vertices. Lengths in Å.
struct EdgeLanes {
  // Not a power of two: arrays a multiple of a page apart get in each other's way.
  static constexpr std::size_t kMost = 3 * kBrickNodes + 8;
  template <class T>
  using Lanes = std::array<T, kMost>;

  std::size_t count = 0;
  Lanes<float> middle[3];  // from node 0
  // The vertex, seen from the grid's origin and from its sphere's centre; its unit normal.
  Lanes<double> position[3], radial[3];
  Lanes<float> normal[3];
  Lanes<SphereId> sphere;
  Lanes<std::uint8_t> clamped;

  // Sets bit k - first of bits[e] for the balls k = first .. first + 31 that may touch edge e.
  void find_touching(const NearBalls& balls, float spacing, std::size_t first,
                     std::uint32_t* bits) const;
  // Normals from radial vectors, with the roundings of unit_or(); says how many have no direction.
  std::int64_t find_normals();
};

inline void EdgeLanes::find_touching(const NearBalls& balls, float spacing, std::size_t first,
                                     std::uint32_t* bits) const {
  const std::size_t last = std::min(balls.size(), first + 32);
  std::fill_n(bits, count, 0u);
  for (std::size_t k = first; k < last; ++k) {
    const float cx = balls.center[0][k], cy = balls.center[1][k], cz = balls.center[2][k];
    // A ball that touches the edge comes within half its length of its middle.
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
