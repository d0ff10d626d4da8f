// placed_balls(): sorts the spheres along a Hilbert curve and scales them.
//
// The spheres are sorted by key, then centre, then radius, largest first, then id. So the first of
// the spheres with one centre is the one that PlacedBalls keeps, and the others are removed.
#include "complex/placed_balls.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

#include "core/buffer.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "spheres/box.hpp"
#include "spheres/spatial_frame.hpp"

namespace vdwmesh {
namespace {

struct Keyed {
  std::uint64_t key;
  SphereId id;
};

// The ids of the balls with distinct centres, in the order of the frame.
std::vector<SphereId> placed_ids(const SphereSet& spheres, const SpatialFrame& frame) {
  Buffer<Keyed> keyed(spheres.size());
  for_each_index(keyed.size(), [&](std::size_t i) {
    keyed[i] = {frame.key(spheres[i].center), static_cast<SphereId>(i)};
  });
  tbb::parallel_sort(keyed.begin(), keyed.end(), [&](const Keyed& i, const Keyed& j) {
    const Sphere &a = spheres[i.id], &b = spheres[j.id];
    if (i.key != j.key || a.center != b.center) {
      return comes_before(i.key, a.center, j.key, b.center);
    }
    return a.radius != b.radius ? a.radius > b.radius : i.id < j.id;
  });
  const auto last = std::unique(keyed.begin(), keyed.end(), [&](const Keyed& i, const Keyed& j) {
    return spheres[i.id].center == spheres[j.id].center;
  });
  std::vector<SphereId> ids(static_cast<std::size_t>(last - keyed.begin()));
  std::transform(keyed.begin(), last, ids.begin(), [](const Keyed& k) { return k.id; });
  return ids;
}

void check_not_empty(const SphereSet& spheres) {
  if (spheres.empty()) throw InvalidInput("an empty set of spheres has no triangulation");
}

Sphere scaled(const Sphere& s, int exponent) {
  return {{std::ldexp(s.center.x, -exponent), std::ldexp(s.center.y, -exponent),
           std::ldexp(s.center.z, -exponent)},
          std::ldexp(s.radius, -exponent)};
}

// A length that no side of the box exceeds. It is at least 2^-40 of every coordinate, so that
// adding it to them survives rounding. Throws InvalidInput if coordinates of up to 32 times this
// length would not be finite.
double reach_of(const Box& box) {
  double reach = 0;
  for (int k = 0; k < 3; ++k) {
    constexpr double kLeastRelativeReach = 0x1p-40;
    reach =
        std::max({reach, box.upper[k] - box.lower[k], kLeastRelativeReach * std::abs(box.lower[k]),
                  kLeastRelativeReach * std::abs(box.upper[k])});
  }
  // With room for sums.
  if (!std::isfinite(64 * reach)) throw InvalidInput("the spheres' extent overflows a double");
  return reach;
}

}  // namespace

// A corner below the bounding box and three points along the axes from there. With the box's size
// at most `reach`, every point of the box has coordinates of 4 to 5 reach from the corner. Their
// sum is at most 15 reach, and the far facet is where the sum is 32 reach. So every ball is far
// inside.
std::array<Vec3d, 4> auxiliary_points(const std::vector<Sphere>& balls) {
  const Box box = box_around(balls);
  const double reach = reach_of(box);
  const Vec3d corner = box.lower - Vec3d{4 * reach, 4 * reach, 4 * reach};
  std::array<Vec3d, 4> points{corner, corner, corner, corner};
  for (int k = 0; k < 3; ++k) points[static_cast<std::size_t>(k) + 1][k] += 32 * reach;
  return points;
}

int scale_exponent(const SphereSet& spheres) {
  check_not_empty(spheres);
  return std::ilogb(std::ranges::max(spheres.spheres(), {}, &Sphere::radius).radius) + 1;
}

PlacedBalls placed_balls(const SphereSet& spheres) {
  const int exponent = scale_exponent(spheres);
  return placed_balls(spheres, spatial_frame(spheres), exponent);
}

PlacedBalls placed_balls(const SphereSet& spheres, const SpatialFrame& frame, int exponent) {
  check_not_empty(spheres);
  PlacedBalls out;
  out.ids = placed_ids(spheres, frame);
  out.scale_exponent = exponent;
  out.balls.resize(out.ids.size());
  for_each_index(out.ids.size(), [&](std::size_t i) {
    out.balls[i] = scaled(spheres[out.ids[i]], out.scale_exponent);
  });
  reach_of(box_around(out.balls));  // throws
  return out;
}

}  // namespace vdwmesh
