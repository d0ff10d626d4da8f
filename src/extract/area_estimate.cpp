#include "extract/area_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "extract/cell_list.hpp"

namespace vdwmesh {
namespace {

constexpr std::uint64_t kSampledSpheres = 4096;
constexpr int kPointsPerSphere = 32;

// The k-th of a spiral of equally spaced directions (Fibonacci lattice).
Vec3d direction(int k) {
  const double z = 1 - (2 * k + 1) / static_cast<double>(kPointsPerSphere);
  const double angle = k * std::numbers::pi * (3 - std::sqrt(5.0));
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

// On or in another ball. Of balls that share the point, the first owns it.
bool is_covered(const CellListView& list, std::uint32_t own, const Vec3d& p) {
  constexpr double kSlack = 1e-9;  // relative: points on equal spheres are told by their order
  return visit_near_box(list, p, p, [&](std::uint32_t place) {
    const Sphere& ball = list.spheres[place];
    const double square = ball.radius * ball.radius;
    const Vec3d d = p - ball.center;
    if (place == own) return false;
    return dot(d, d) < square * (place < own ? 1 + kSlack : 1 - kSlack);
  });
}

double exposed_part(const CellListView& list, std::uint32_t own) {
  const Sphere& ball = list.spheres[own];
  int exposed = 0;
  for (int k = 0; k < kPointsPerSphere; ++k)
    exposed += !is_covered(list, own, ball.center + ball.radius * direction(k));
  return exposed / static_cast<double>(kPointsPerSphere);
}

}  // namespace

double estimate_area(const SphereSet& spheres) {
  if (spheres.empty()) return 0;
  const CellList list = make_ball_list(spheres);
  const std::uint64_t sampled = std::min<std::uint64_t>(spheres.size(), kSampledSpheres);
  double sum = 0;
  for (std::uint64_t i = 0; i < sampled; ++i) {
    const auto place = static_cast<std::uint32_t>(i * spheres.size() / sampled);
    const double r = list.view().spheres[place].radius;
    sum += 4 * std::numbers::pi * r * r * exposed_part(list.view(), place);
  }
  return sum * static_cast<double>(spheres.size()) / static_cast<double>(sampled);
}

}  // namespace vdwmesh
