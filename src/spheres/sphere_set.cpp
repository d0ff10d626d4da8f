// SphereSet checks its spheres when they enter the set, so that functions that take a set need no
// checks of their own. Every change gives the set a new revision number, by which caches see that
// its contents are new.
// canonical_order() sorts by (x, y, z, radius, id), in parallel.
#include "spheres/sphere_set.hpp"

#include <fmt/format.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "core/errors.hpp"
#include "spheres/check_sphere.hpp"

namespace vdwmesh {
namespace {

// The smallest box around balls at the spheres' centres with the radii reach(sphere).
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

void check(std::span<const Sphere> spheres) {
  if (spheres.size() >= kNoSphere) {
    throw InvalidInput(fmt::format("{} spheres; at most {} fit", spheres.size(), kNoSphere - 1));
  }
  for (std::size_t i = 0; i < spheres.size(); ++i) check_sphere(spheres[i], i);
}

// Returns a number above 0 that no set has had. 0 is the revision of a default-constructed set.
std::uint64_t next_revision() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

void check_sphere(const Sphere& s, std::size_t i) {
  if (is_sphere(s)) return;
  const Vec3d& c = s.center;
  throw InvalidInput(fmt::format(
      "sphere {}: centre ({}, {}, {}) and radius {}; coordinates must be at most {:g} Å from "
      "0, and radii above 0 and at most {:g} Å",
      i, c.x, c.y, c.z, s.radius, kFarthestSphere, kFarthestSphere));
}

double grown_radius(double radius, double probe, const char* name, std::size_t index) {
  if (!std::isfinite(radius) || radius < 0) {
    throw InvalidInput(
        fmt::format("{}[{}]: {} is no radius; radii are finite, not negative, in angstrom", name,
                    index, radius));
  }
  const double grown = radius + probe;
  if (grown > 0) return grown;
  throw InvalidInput(
      fmt::format("{}[{}]: {} with probe {} would be {}; every radius must stay above 0", name,
                  index, radius, probe, grown));
}

SphereSet::SphereSet(std::vector<Sphere> spheres)
    : owned_(std::move(spheres)), spheres_(owned_), revision_(next_revision()) {
  check(spheres_);
}

// A copy of a set that looks at the caller's spheres looks at the same spheres.
SphereSet::SphereSet(const SphereSet& other)
    : owned_(other.owned_),
      spheres_(owned_.empty() ? other.spheres_ : owned_),
      revision_(other.revision_) {}

// The elements of a vector keep their addresses when it is swapped, so the spans remain valid.
void SphereSet::swap(SphereSet& other) noexcept {
  std::swap(owned_, other.owned_);
  std::swap(spheres_, other.spheres_);
  std::swap(revision_, other.revision_);
}

SphereSet SphereSet::view(std::span<const Sphere> spheres) {
  check(spheres);
  SphereSet set;
  set.spheres_ = spheres;
  set.revision_ = next_revision();
  return set;
}

SphereSet SphereSet::view(std::span<const double> rows) {
  static_assert(std::is_standard_layout_v<Sphere> && sizeof(Sphere) == 4 * sizeof(double) &&
                offsetof(Sphere, radius) == 3 * sizeof(double));
  if (rows.size() % 4 != 0) {
    throw InvalidInput(fmt::format(
        "{} numbers are no rows of x, y, z and radius: their count must be a multiple of 4",
        rows.size()));
  }
  // The assertion above makes sure that a Sphere has the layout of a row.
  return view(std::span(reinterpret_cast<const Sphere*>(rows.data()), rows.size() / 4));
}

void SphereSet::move_to(std::span<const Vec3d> centers) {
  if (centers.size() != size()) {
    throw InvalidInput(
        fmt::format("{} centres for a set of {} spheres: each needs one", centers.size(), size()));
  }
  for (std::size_t i = 0; i < centers.size(); ++i) {
    check_sphere({centers[i], (*this)[i].radius}, i);
  }
  if (owned_.empty()) {
    owned_.assign(spheres_.begin(), spheres_.end());
    spheres_ = owned_;
  }
  for (std::size_t i = 0; i < centers.size(); ++i) owned_[i].center = centers[i];
  revision_ = next_revision();
}

Box bounding_box(const SphereSet& spheres) {
  return bounds(spheres, [](const Sphere& s) { return s.radius; });
}

Box center_bounding_box(const SphereSet& spheres) {
  return bounds(spheres, [](const Sphere&) { return 0.0; });
}

std::vector<SphereId> canonical_order(const SphereSet& spheres) {
  std::vector<SphereId> order;
  canonical_order(spheres, order);
  return order;
}

void canonical_order(const SphereSet& spheres, std::vector<SphereId>& order) {
  // Most comparisons need x only. It is stored beside the id, so they do not read the spheres.
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
  order.resize(keys.size());
  std::ranges::transform(keys, order.begin(), &Key::id);
}

}  // namespace vdwmesh
