// Sets of balls whose union is known, and small helpers for tests of the exact union.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "measures/exact_union.hpp"
#include "support/gauss_bonnet.hpp"

// Relative; written so that NaN fails.
#define EXPECT_RELATIVE(actual, expected, tolerance)                                     \
  EXPECT_TRUE(std::abs((actual) - (expected)) <= (tolerance)*std::abs(expected))         \
      << #actual " = " << (actual) << ", expected " << (expected) << ", relative error " \
      << (actual) / (expected)-1

namespace vdwmesh::testing {

// Method cgal gets a check, by other formulas on the same complex.
inline ExactUnion unite(std::vector<Sphere> spheres, UnionMethod method = UnionMethod::cgal) {
  const SphereSet set(std::move(spheres));
  ExactUnion result = exact_union(set, {method, nullptr});
  if (method == UnionMethod::cgal) {
    const SphereMeasures check = by_gauss_bonnet(set);
    result.check_area = check.area;
    result.check_volume = check.volume;
  }
  return result;
}

inline std::vector<Sphere> cubic_lattice(int side, double spacing, double radius) {
  std::vector<Sphere> spheres;
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        spheres.push_back({{spacing * x, spacing * y, spacing * z}, radius});
      }
    }
  }
  return spheres;
}

inline std::vector<Sphere> jittered(std::vector<Sphere> spheres, double amplitude,
                                    std::mt19937_64& random) {
  std::uniform_real_distribution<double> shift(-amplitude, amplitude);
  for (Sphere& s : spheres)
    s.center = s.center + Vec3d{shift(random), shift(random), shift(random)};
  return spheres;
}

// The truncated icosahedron with unit edges times `bond`.
inline std::vector<Sphere> buckminsterfullerene(double bond, double radius) {
  const double phi = std::numbers::phi;
  const double base[3][3] = {{0, 1, 3 * phi}, {1, 2 + phi, 2 * phi}, {phi, 2, 2 * phi + 1}};
  std::vector<Sphere> spheres;
  for (const auto& b : base) {
    for (int turn = 0; turn < 3; ++turn) {
      for (int signs = 0; signs < 8; ++signs) {
        if (b[0] == 0 && (signs & 1) != 0) continue;
        double v[3];
        for (int k = 0; k < 3; ++k) {
          v[(k + turn) % 3] = ((signs >> k) & 1 ? -b[k] : b[k]) * bond / 2;
        }
        spheres.push_back({{v[0], v[1], v[2]}, radius});
      }
    }
  }
  return spheres;
}

// Up to 14 balls on a small grid of integers with few radii: full of duplicates, nested, tangent,
// collinear, coplanar and co-spherical balls.
inline std::vector<Sphere> degenerate_grid(std::mt19937_64& random) {
  const auto pick = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  const int count = pick(1, 14), reach = pick(1, 4), dimension = pick(1, 3), largest = pick(1, 6);
  const bool equal = pick(0, 1) == 1;
  const double common = 0.5 * pick(1, largest);
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) {
    Sphere s{{0, 0, 0}, equal ? common : 0.5 * pick(1, largest)};
    for (int k = 0; k < dimension; ++k) s.center[k] = pick(-reach, reach);
    spheres.push_back(s);
  }
  return spheres;
}

}  // namespace vdwmesh::testing
