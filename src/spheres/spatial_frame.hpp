// The order of spheres by place: along Hilbert's curve through a cube around all centres.
//
// The order of two spheres depends on their centres and on the cube alone. So whoever has a part of
// a set, and the cube of the whole set, numbers that part in the order of the whole.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/order/hilbert.hpp"
#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

struct SpatialFrame {
  Vec3d lower{};      // the lower corner of the cube, Å
  double extent = 0;  // its side, Å

  // A coordinate that is not finite counts as 0.
  std::uint64_t key(const Vec3d& center) const {
    return hilbert_key(cell(center.x - lower.x), cell(center.y - lower.y),
                       cell(center.z - lower.z));
  }

 private:
  std::uint32_t cell(double from_lower) const {
    constexpr std::uint32_t cells = 1u << kHilbertBits;
    const double part = from_lower / extent;
    return part > 0 ? (part < 1 ? static_cast<std::uint32_t>(part * cells) : cells - 1) : 0;
  }
};

// Whether a centre comes before another one, given their keys. Equal keys are decided by the
// coordinates, so only equal centres are not in order.
inline bool comes_before(std::uint64_t key_a, const Vec3d& a, std::uint64_t key_b, const Vec3d& b) {
  if (key_a != key_b) return key_a < key_b;
  if (a.x != b.x) return a.x < b.x;
  return a.y != b.y ? a.y < b.y : a.z < b.z;
}

// The frame of a set that is not empty. The cube is wider than the box around all centres, by
// numbers without meaning: in symmetric sets centres stand at halves and quarters of the box, where
// rounding would choose the cell, and a translation of the set would change its order.
inline SpatialFrame spatial_frame(const SphereSet& spheres) {
  const Box centers = center_bounding_box(spheres);
  constexpr double kBelow = 0.0871557, kSide = 1.2137049;
  const Vec3d size = centers.upper - centers.lower;
  const double extent = std::max({size.x, size.y, size.z});
  return {centers.lower - kBelow * extent * Vec3d{1, 1, 1}, kSide * extent};
}

}  // namespace vdwmesh
