#include "extract/area_estimate.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/multiversion.hpp"
#include "extract/blended/field_sample.hpp"
#include "extract/field_list.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {
namespace {

constexpr std::uint64_t kSampledSpheres = 4096;
constexpr int kPointsPerSphere = 32;
// Of a field: few for many spheres.
constexpr std::uint64_t kRays = 16384;
constexpr int kFewestRays = 4, kMostRays = 128;
constexpr double kRayStep = 0.25;     // of the radius
constexpr double kLeastCosine = 0.1;  // of a ray to the normal: none counts for more than tenfold

// The k-th of a spiral of equally spaced directions (Fibonacci lattice).
Vec3d direction(int k, int count) {
  const double z = 1 - (2 * k + 1) / static_cast<double>(count);
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
    exposed += !is_covered(list, own, ball.center + ball.radius * direction(k, kPointsPerSphere));
  return exposed / static_cast<double>(kPointsPerSphere);
}

// Sums area_of(place) over evenly spaced places of the list, and scales to all.
template <class AreaOf>
double sum_over_sample(std::uint64_t spheres, const AreaOf& area_of) {
  if (spheres == 0) return 0;
  const std::uint64_t sampled = std::min(spheres, kSampledSpheres);
  std::vector<double> areas(sampled);
  tbb::parallel_for(std::uint64_t{0}, sampled, [&](std::uint64_t i) {
    areas[i] = area_of(static_cast<std::uint32_t>(i * spheres / sampled));
  });
  double sum = 0;
  for (const double area : areas) sum += area;
  return sum * static_cast<double>(spheres) / static_cast<double>(sampled);
}

// From the centre of a sphere outwards while its contribution is the largest: what the first way
// out of the surface stands for, per solid angle. Every point of the surface belongs to one sphere,
// and a patch dA at distance r fills the solid angle dA cos / r².
double area_along(const CellListView& list, const FieldModel& model, std::uint32_t own,
                  const Vec3d& u) {
  const Sphere& ball = list.spheres[own];
  const double step = kRayStep * ball.radius, reach = field_reach(model, ball.radius);
  double r = 0, value = 0;  // at r, from the second step on
  while (r < reach) {
    const FieldSample next = sample_field(list, model, ball.center + (r + step) * u);
    if (next.value >= model.isovalue) {
      if (next.place != own) return 0;
      value = next.value;
      r += step;
      continue;
    }
    if (!(value > 0)) return 0;
    const double way = r + step * (value - model.isovalue) / (value - next.value);
    const FieldSample at = sample_field(list, model, ball.center + way * u);
    if (!at.in_reach || at.place != own) return 0;
    const double cosine = std::abs(dot(at.gradient, u)) / norm(at.gradient);
    return way * way / std::clamp(cosine, kLeastCosine, 1.0);
  }
  return 0;
}

VDWMESH_MULTIVERSION double area_along_rays(const CellListView& list, const FieldModel& model,
                                            std::uint32_t own, int rays) {
  double sum = 0;
  for (int k = 0; k < rays; ++k) sum += area_along(list, model, own, direction(k, rays));
  return 4 * std::numbers::pi / rays * sum;
}

}  // namespace

double estimate_area(const SphereSet& spheres) {
  const CellList list = make_ball_list(spheres);
  return sum_over_sample(spheres.size(), [&](std::uint32_t place) {
    const double r = list.view().spheres[place].radius;
    return 4 * std::numbers::pi * r * r * exposed_part(list.view(), place);
  });
}

double estimate_area(const SphereSet& spheres, const FieldModel& model) {
  const CellList list = make_field_list(spheres, model);
  const std::uint64_t wanted = kRays / std::max<std::uint64_t>(spheres.size(), 1);
  const int rays = static_cast<int>(std::clamp<std::uint64_t>(wanted, kFewestRays, kMostRays));
  return sum_over_sample(spheres.size(), [&](std::uint32_t place) {
    return area_along_rays(list.view(), model, place, rays);
  });
}

}  // namespace vdwmesh
