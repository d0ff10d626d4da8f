// The octree of caps. A cube that may have a point of the sphere and has more than a few caps is
// divided, and each of its parts takes those of the caps that come near to it. The cubes are
// divided level by level until the lists have become many times as long as that of all caps: where
// many rims run side by side, cubes keep more caps.
#include "creases/arcs/cap_margins.hpp"

#include "core/steps.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kManyCaps = 64;
constexpr std::uint32_t kFewCaps = 8;  // a cube with so many stays whole
constexpr std::size_t kLongest = 64;   // the lists together, as a multiple of the caps
constexpr double kLeastHalfWidth = 1e-5;
// What is decided about a cube holds a distance of kSlack farther, so rounding does not matter. It
// is above the rounding of the distance that belongs to a cosine near 1.
constexpr double kSlack = 1e-7;

// The straight distance from the rim of a cap to its centre, if the cosine is that of its angular
// radius.
double reach_of(double cosine) { return std::sqrt(std::max(0.0, 2 - 2 * cosine)); }

// Whether no point of the sphere that is at most `around` away from `center` has a product with the
// axis above the bound.
bool is_beyond(const Vec3d& axis, double bound, const Vec3d& center, double around) {
  if (bound >= 0) return norm(center - axis) > reach_of(bound) + around;
  return norm(center + axis) + around < reach_of(-bound);
}

// Whether the cap covers all points of the sphere that are at most `around` away from `center`.
bool covers_all(const CoveredCap& cap, const Vec3d& center, double around) {
  const double reach = std::sqrt(cap.squared_distance);
  if (cap.cosine >= 0) return norm(center - cap.axis) + around < reach;
  return norm(center + cap.axis) > reach + around;
}

}  // namespace

template <>
void CapTree<GrowingMemory>::build(std::span<const double> bounds, Monitor* monitor) {
  if (caps_.size() <= kManyCaps) return;
  Steps steps(monitor);
  cubes_.push_back({{0, 0, 0}, 1, 0, static_cast<std::uint32_t>(caps_.size()), 0});
  for (std::uint32_t i = 0; i < caps_.size(); ++i) lists_.push_back(i);
  for (std::size_t at = 0; at < cubes_.size(); ++at) {
    const Cube cube = cubes_[at];
    if (cube.count <= kFewCaps || cube.half_width < kLeastHalfWidth) continue;
    if (lists_.size() > kLongest * caps_.size()) return;
    cubes_[at].children = static_cast<std::uint32_t>(cubes_.size());
    for (int part = 0; part < 8; ++part) {
      const double half = cube.half_width / 2;
      const Vec3d center = cube.center + Vec3d{part & 1 ? half : -half, part & 2 ? half : -half,
                                               part & 4 ? half : -half};
      const double around = std::sqrt(3.0) * half + kSlack;
      const auto first = static_cast<std::uint32_t>(lists_.size());
      // Parts away from the sphere get no caps.
      const bool has_points = std::abs(norm(center) - 1) <= around;
      for (std::uint32_t i = 0; has_points && i < cube.count; ++i) {
        steps.add(1);
        const std::uint32_t cap = lists_[cube.first + i];
        if (is_beyond(caps_[cap].axis, bounds[cap], center, around)) continue;
        const bool is_alone = covers_all(caps_[cap], center, around);
        if (is_alone) lists_.resize(first);
        lists_.push_back(cap);
        if (is_alone) break;
      }
      cubes_.push_back({center, half, first, static_cast<std::uint32_t>(lists_.size()) - first, 0});
    }
  }
}

template <>
std::span<const std::uint32_t> CapTree<GrowingMemory>::near(const Vec3d& u) const {
  std::uint32_t at = 0;
  while (const std::uint32_t children = cubes_[at].children) {
    const Vec3d& c = cubes_[at].center;
    at = children + (u.x >= c.x ? 1u : 0u) + (u.y >= c.y ? 2u : 0u) + (u.z >= c.z ? 4u : 0u);
  }
  return {lists_.data() + cubes_[at].first, cubes_[at].count};
}

}  // namespace vdwmesh
