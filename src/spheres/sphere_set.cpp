#include "spheres/sphere_set.hpp"

#include <fmt/format.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

template <class Reach>
Box bounds(const SphereSet& spheres, Reach reach) {
  const double first = reach(spheres[0]);
  const Vec3d& c0 = spheres[0].center;
  Box box{{c0.x - first, c0.y - first, c0.z - first}, {c0.x + first, c0.y + first, c0.z + first}};
  for (const Sphere& s : spheres.spheres()) {
    const double r = reach(s);
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] = std::min(box.lower[axis], s.center[axis] - r);
      box.upper[axis] = std::max(box.upper[axis], s.center[axis] + r);
    }
  }
  return box;
}

}  // namespace

SphereSet::SphereSet(std::vector<Sphere> spheres) : spheres_(std::move(spheres)) {
  if (spheres_.size() >= kNoSphere) {
    throw InvalidInput(fmt::format("{} spheres; at most {} fit", spheres_.size(), kNoSphere - 1));
  }
  for (std::size_t i = 0; i < spheres_.size(); ++i) {
    const Sphere& s = spheres_[i];
    const Vec3d& c = s.center;
    const bool near = std::abs(c.x) <= kFarthestSphere && std::abs(c.y) <= kFarthestSphere &&
                      std::abs(c.z) <= kFarthestSphere;  // false for what is not a number
    if (!near || !(s.radius > 0) || !(s.radius <= kFarthestSphere)) {
      throw InvalidInput(fmt::format(
          "sphere {}: centre ({}, {}, {}) and radius {}; coordinates must be at most {:g} Å from "
          "0, and radii above 0 and at most {:g} Å",
          i, c.x, c.y, c.z, s.radius, kFarthestSphere, kFarthestSphere));
    }
  }
}

Box bounding_box(const SphereSet& spheres) {
  return bounds(spheres, [](const Sphere& s) { return s.radius; });
}

Box center_bounding_box(const SphereSet& spheres) {
  return bounds(spheres, [](const Sphere&) { return 0.0; });
}

std::vector<SphereId> canonical_order(const SphereSet& spheres) {
  // Most comparisons are of x alone, which stands beside the number: no sphere is looked up.
  struct Key {
    double x;
    SphereId id;
  };
  std::vector<Key> keys(spheres.size());
  for (SphereId i = 0; i < keys.size(); ++i) keys[i] = {spheres[i].center.x, i};
  const auto rest = [&](SphereId i) {
    const Sphere& s = spheres[i];
    return std::tuple(s.center.y, s.center.z, s.radius, i);
  };
  tbb::parallel_sort(keys.begin(), keys.end(), [&](const Key& a, const Key& b) {
    return a.x != b.x ? a.x < b.x : rest(a.id) < rest(b.id);
  });
  std::vector<SphereId> order(keys.size());
  std::ranges::transform(keys, order.begin(), &Key::id);
  return order;
}

}  // namespace vdwmesh
