// Shares of spheres: the spheres are numbered layer by layer across the longest axis, in their
// order within a layer, and each part has a run of these numbers. A sphere is near to a part if its
// interval along the axis meets that of the part.
#include "distributed/sphere_shares.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

#include "distributed/layers.hpp"

namespace vdwmesh {
namespace {

// Of the lengths that are compared, and of the coordinates: more than spheres that are taken for
// touching are apart (arcs/doubts.hpp), and than differences of coordinates are rounded by.
constexpr double kSlack = 1e-6, kRounding = 1e-14;

int longest_axis(const SphereSet& spheres) {
  const Box box = center_bounding_box(spheres);
  const Vec3d size = box.upper - box.lower;
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (size[axis] > size[longest]) longest = axis;
  }
  return longest;
}

// The interval along the axis that spheres take, Å, and the largest of their radii.
struct Extent {
  double lower = std::numeric_limits<double>::infinity(), upper = -lower, radius = 0;

  void add(const Sphere& s, int axis) {
    lower = std::min(lower, s.center[axis] - s.radius);
    upper = std::max(upper, s.center[axis] + s.radius);
    radius = std::max(radius, s.radius);
  }
  bool may_touch(const Sphere& s, int axis) const {
    const double slack = kSlack * (s.radius + radius) + kRounding * std::abs(s.center[axis]);
    return s.center[axis] + s.radius + slack >= lower && s.center[axis] - s.radius - slack <= upper;
  }
};

}  // namespace

SphereShare share_of_spheres(const SphereSet& spheres, std::size_t part, std::size_t parts) {
  const std::uint64_t first = spheres.size() * part / parts,
                      end = spheres.size() * (part + 1) / parts;
  if (first == end) return {};
  const int axis = longest_axis(spheres);
  const Layers layers(spheres, axis);
  std::vector<std::uint64_t> next = layers.starts();  // [layer]: number of its next sphere
  std::vector<SphereId> own;
  Extent extent;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const std::uint64_t number = next[layers.layer_of(spheres[i])]++;
    if (number < first || number >= end) continue;
    own.push_back(static_cast<SphereId>(i));
    extent.add(spheres[i], axis);
  }
  SphereShare share;
  share.near =
      choose(spheres, [&](SphereId, const Sphere& s) { return extent.may_touch(s, axis); });
  // The share is part of what is near, and both are in the order of the set.
  std::size_t place = 0;
  for (const SphereId id : own) {
    while (share.near.ids[place] != id) ++place;
    share.own.push_back(static_cast<SphereId>(place));
  }
  return share;
}

}  // namespace vdwmesh
