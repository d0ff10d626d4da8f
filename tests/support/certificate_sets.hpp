// Sets of balls for certificates, and the verdict on one: whether the intervals contain what the
// oracle finds with 60 digits.
#pragma once

#include <random>
#include <vector>

#include "measures/certificate/certify.hpp"
#include "reference/union_oracle.hpp"
#include "support/sphere_recipes.hpp"
#include "unit/arrangement/union_cases.hpp"

namespace vdwmesh::testing {

// Even seeds: the recipes of sphere_recipes.hpp, general and nearly degenerate. Odd seeds: balls on
// a small grid of integers, which coincide, touch, nest and meet in common points exactly.
inline SphereSet certificate_set(unsigned seed) {
  if (seed % 2 == 0) return seeded_set(seed / 2).spheres;
  std::mt19937_64 random(seed);
  return SphereSet(degenerate_grid(random));
}

inline UnionCertificate certificate_of(
    const SphereSet& spheres, certificate::RoundingMode mode = certificate::RoundingMode::upward) {
  const PowerTriangulation triangulation = triangulate(spheres);
  return certify(spheres, triangulation, dual_complex(triangulation),
                 MeasuredSpheres(spheres.size(), std::nullopt), nullptr, mode);
}

inline reference::WideMeasures true_measures(const SphereSet& spheres) {
  std::vector<reference::Ball> balls;
  for (const Sphere& s : spheres.spheres()) {
    balls.push_back({{{s.center.x, s.center.y, s.center.z}}, s.radius});
  }
  return reference::union_oracle(balls);
}

inline bool contains(const Enclosure& interval, const reference::Digits& value) {
  return interval.lower <= value && value <= interval.upper;
}
inline bool contains(const UnionCertificate& certificate, const reference::WideMeasures& truth) {
  return contains(certificate.area, truth.area) && contains(certificate.volume, truth.volume);
}

// NaN if the interval is at 0.
inline double relative_width(const Enclosure& e) { return (e.upper - e.lower) / e.lower; }

}  // namespace vdwmesh::testing
