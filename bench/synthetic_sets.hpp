// Sets of spheres that benchmarks make themselves.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// 4,000 atoms at 0.05 per Å³, at least 2 Å apart, in a ball; radii 1.52 to 1.80 Å.
inline SphereSet synthetic_cluster() {
  constexpr unsigned seed = 20240607;
  constexpr std::size_t count = 4000;
  const double ball = std::cbrt(count / 0.05 * 3 / (4 * std::acos(-1.0)));
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-ball, ball), radius(1.52, 1.80);
  std::vector<Sphere> spheres;
  while (spheres.size() < count) {
    const Vec3d p{place(random), place(random), place(random)};
    if (norm(p) > ball) continue;
    const bool free = std::all_of(spheres.begin(), spheres.end(), [&](const Sphere& s) {
      return squared_norm(p - s.center) >= 4.0;
    });
    if (free) spheres.push_back({p, radius(random)});
  }
  std::printf("synthetic cluster: seed %u, %zu atoms in a ball of radius %.3f Å\n", seed,
              spheres.size(), ball);
  return SphereSet(spheres);
}

// Copies of a set side by side along x.
inline SphereSet side_by_side(const SphereSet& one, int copies) {
  const Box box = bounding_box(one);
  std::vector<Sphere> all;
  for (int c = 0; c < copies; ++c) {
    for (Sphere s : one.spheres()) {
      s.center.x += c * (box.upper.x - box.lower.x);
      all.push_back(s);
    }
  }
  return SphereSet(all);
}

}  // namespace vdwmesh
