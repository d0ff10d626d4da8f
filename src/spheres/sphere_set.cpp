// SphereSet checks its spheres when they enter the set, so that functions that take a set need no
// checks of their own. Every change gives the set a new revision number, by which caches see that
// its contents are new.
// canonical_order() sorts by (x, y, z, radius, id), in parallel: into slices along x first, by
// counting, then each slice by comparisons.
#include "spheres/sphere_set.hpp"

#include <fmt/format.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <type_traits>
#include <utility>

#include "core/buffer.hpp"
#include "core/errors.hpp"
#include "core/order/stable_groups.hpp"
#include "spheres/box.hpp"
#include "spheres/check_sphere.hpp"

namespace vdwmesh {
namespace {

// The smallest box around balls at the spheres' centres with the radii reach(sphere).
template <class Reach>
Box bounds(const SphereSet& spheres, Reach reach) {
  const auto box_of_block = [&](std::size_t first, std::size_t end) {
    Box box = empty_box();
    for (std::size_t i = first; i < end; ++i) {
      include(box, box_of({spheres[i].center, reach(spheres[i])}));
    }
    return box;
  };
  return join_blocks(spheres.size(), box_of_block,
                     [](Box& total, const Box& part) { include(total, part); });
}

void check(std::span<const Sphere> spheres) {
  if (spheres.size() >= kNoSphere) {
    throw InvalidInput(fmt::format("{} spheres; at most {} fit", spheres.size(), kNoSphere - 1));
  }
  const auto first_bad = [&](std::size_t first, std::size_t end) {
    while (first < end && is_sphere(spheres[first])) ++first;
    return first < end ? first : spheres.size();
  };
  if (spheres.empty()) return;
  const std::size_t bad =
      join_blocks(spheres.size(), first_bad,
                  [](std::size_t& least, std::size_t part) { least = std::min(least, part); });
  if (bad < spheres.size()) check_sphere(spheres[bad], bad);
}

// Slices of space across the x axis, equally wide and numbered along it: what is in a later slice
// has a larger x. Rounding keeps this, as it keeps the order of differences and of products.
class Slices {
 public:
  explicit Slices(const SphereSet& spheres) : count_(usual_groups(spheres.size())) {
    const auto extent_of = [&](std::size_t first, std::size_t end) {
      Extent extent;
      for (std::size_t i = first; i < end; ++i) extent.add(spheres[i].center.x);
      return extent;
    };
    const Extent all =
        join_blocks(spheres.size(), extent_of, [](Extent& total, const Extent& part) {
          total.add(part.lower);
          total.add(part.upper);
        });
    lower_ = all.lower;
    per_length_ = static_cast<double>(count_) / (all.upper - all.lower);
    if (!std::isfinite(per_length_)) count_ = 1;  // spheres in one plane, or nearly so
  }

  std::size_t count() const { return count_; }
  std::size_t of(double x) const {
    if (count_ == 1) return 0;
    return std::min(static_cast<std::size_t>((x - lower_) * per_length_), count_ - 1);
  }

 private:
  struct Extent {
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
    void add(double x) {
      lower = std::min(lower, x);
      upper = std::max(upper, x);
    }
  };
  std::size_t count_;
  double lower_, per_length_;
};

// What most comparisons of spheres need, so that they do not read the spheres.
struct Key {
  double x;
  SphereId id;
};

// Sorts keys into the canonical order.
void sort_keys(const SphereSet& spheres, std::span<Key> keys) {
  const auto rest = [&](SphereId i) {
    const Sphere& s = spheres[i];
    return std::tuple(s.center.y, s.center.z, s.radius, i);
  };
  const auto is_before = [&](const Key& a, const Key& b) {
    return a.x != b.x ? a.x < b.x : rest(a.id) < rest(b.id);
  };
  constexpr std::size_t kMany = std::size_t{1} << 13;
  if (keys.size() < kMany) {
    std::sort(keys.begin(), keys.end(), is_before);
  } else {
    tbb::parallel_sort(keys.begin(), keys.end(), is_before);
  }
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
      fmt::format("{}[{}]: {} with probe {} would be {:g}; every radius must stay above 0", name,
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

SphereSet grown(std::span<const Sphere> balls, double by) {
  std::vector<Sphere> larger(balls.begin(), balls.end());
  for (Sphere& b : larger) b.radius += by;
  return SphereSet(std::move(larger));
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
  order.resize(spheres.size());
  if (spheres.empty()) return;
  const Slices slices(spheres);
  Buffer<Key> keys(spheres.size());
  const std::vector<std::uint32_t> first = sort_into_groups(
      spheres.size(), slices.count(), [&](std::size_t i) { return slices.of(spheres[i].center.x); },
      [&](std::size_t i, std::uint32_t place) {
        keys[place] = {spheres[i].center.x, static_cast<SphereId>(i)};
      });
  constexpr std::size_t kSlicesPerBlock = 16;
  for_each_block(slices.count(), kSlicesPerBlock,
                 [&](std::size_t, std::size_t begin, std::size_t end) {
                   for (std::size_t slice = begin; slice < end; ++slice) {
                     sort_keys(spheres, {&keys[first[slice]], first[slice + 1] - first[slice]});
                   }
                   for (std::size_t i = first[begin]; i < first[end]; ++i) order[i] = keys[i].id;
                 });
}

}  // namespace vdwmesh
