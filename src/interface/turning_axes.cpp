// AxesSource: polar vectors at a place, sums over the atoms around it, which are made orthonormal
// one after the other. What is too short to tell a direction is left to the next.
#include "interface/turning_axes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "measures/arcs/arc_cap.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh {
namespace {

// What is smaller, of hints of length 1 at most, is no hint: there sums cancel, and rounding is
// enlarged by as much.
constexpr double kClear = 1e-3;

// Distances at which atoms no longer count, Å.
constexpr std::array<double, 3> kReaches{4, 5.5, 7};
constexpr double kFarthestAtom = kReaches.back();

using Hints = std::array<Vec3d, 3>;

// Sums of vectors to atoms by their weights, divided by those of their lengths.
template <class Each, class Weigh>
Hints hints_of(const Each& each_offset, const Weigh& weigh) {
  Hints sum{};
  std::array<double, 3> most{};
  each_offset([&](const Vec3d& offset) {
    const double squared = arcs::inner(offset, offset), length = std::sqrt(squared);
    for (std::size_t k = 0; k < sum.size(); ++k) {
      const double weight = weigh(k, squared, length);
      sum[k] = sum[k] + weight * offset;
      most[k] += weight * length;
    }
  });
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (most[k] > 0) sum[k] = (1 / most[k]) * sum[k];
  return sum;
}

// The first of some vectors that is not nearly 0, with length 1.
template <class Part>
std::optional<Vec3d> first_clear(std::span<const Vec3d> hints, const Part& part) {
  for (const Vec3d& hint : hints) {
    const Vec3d some = part(hint);
    if (norm(some) >= kClear) return unit(some);
  }
  return std::nullopt;
}

// Completes the axes, and says whether all three are clear.
bool complete(std::span<const Vec3d> hints, TurningAxes& axes) {
  auto& [first, second, third] = axes.axis;
  const auto one = first_clear(hints, [](const Vec3d& hint) { return hint; });
  first = one.value_or(Vec3d{0, 0, 1});
  const auto two =
      first_clear(hints, [&](const Vec3d& hint) { return hint - dot(hint, first) * first; });
  second = two.value_or(any_orthogonal(first));
  third = cross(first, second);
  const auto three =
      first_clear(hints, [&](const Vec3d& hint) { return dot(hint, third) * third; });
  third = three.value_or(third);
  return one && two && three;
}

}  // namespace

// One of two axes makes an angle of 45 degrees with v, or more.
Vec3d TurningAxes::across(const Vec3d& v) const {
  constexpr double kEnough = 0.5;
  const auto part = [&](const Vec3d& a) { return a - dot(a, v) * v; };
  const Vec3d first = part(axis[0]);
  return unit(norm(first) > kEnough ? first : part(axis[1]));
}

bool TurningAxes::opposes(const Vec3d& v) const {
  for (const Vec3d& a : axis) {
    const double along = dot(a, v);
    if (std::abs(along) >= kClear) return along < 0;
  }
  return false;
}

AxesSource::AxesSource(std::span<const Vec3d> centers)
    : centers_(centers), grid_(centers, kFarthestAtom / 3) {}

TurningAxes AxesSource::at(const Vec3d& place) const {
  const Hints near = hints_of(
      [&](const auto& add) {
        grid_.each_near(place, kFarthestAtom * kFarthestAtom,
                        [&](std::uint32_t i, double) { add(centers_[i] - place); });
      },
      [](std::size_t k, double squared, double) {
        const double left = std::max(0.0, 1 - squared / (kReaches[k] * kReaches[k]));
        return left * left;
      });
  TurningAxes axes{};
  if (complete(near, axes)) return axes;
  const Hints all = hints_of(
      [&](const auto& add) {
        for (const Vec3d& center : centers_) add(center - place);
      },
      [](std::size_t k, double squared, double length) {
        return k == 0 ? 1 : k == 1 ? length : squared;
      });
  std::array<Vec3d, 6> both{};
  std::ranges::copy(near, both.begin());
  std::ranges::copy(all, both.begin() + near.size());
  complete(both, axes);
  return axes;
}

}  // namespace vdwmesh
