// Volumes of pockets against points that are thrown into their tetrahedra and looked up in all
// balls, on 300 random and degenerate sets.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "complex/dual_complex.hpp"
#include "pockets/pocket_flow.hpp"
#include "pockets/pockets.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

// Balls of a kind that the number says: at random places, on a lattice with equal radii or with
// different ones, and with repeated and concentric balls.
std::vector<Sphere> balls_of(unsigned seed) {
  Dice dice(seed);
  std::vector<Sphere> balls;
  const auto add = [&](const Vec3d& place, double radius) { balls.push_back({place, radius}); };
  const unsigned kind = seed % 3;
  if (kind == 0) {
    for (int i = dice.whole(8, 40); i > 0; --i) {
      add({dice.real(0, 7), dice.real(0, 7), dice.real(0, 7)}, dice.real(0.7, 1.8));
    }
    return balls;
  }
  const double edge = dice.real(2.4, 3.4), radius = dice.real(0.4, 0.75) * edge;
  for (int i = 0; i < 27; ++i) {
    if (dice.one_in(6)) continue;
    const Vec3d place{edge * (i % 3), edge * (i / 3 % 3), edge * (i / 9)};
    add(place, kind == 1 ? radius : radius * (dice.one_in(2) ? 1 : 0.9));
    if (dice.one_in(8)) add(place, dice.one_in(2) ? radius : radius / 2);
  }
  return balls;
}

struct Counted {
  double volume = 0, variance = 0;
};

// Of the tetrahedra that are in pockets.
Counted count_points(const SphereSet& spheres, Dice& dice) {
  constexpr int kPoints = 400;  // in each tetrahedron
  const PowerTriangulation t = triangulate(spheres);
  const PocketFlow flow = pocket_flow(t, dual_complex(t), nullptr);
  const double scale = std::ldexp(1.0, t.scale_exponent);
  Counted sum;
  for (const std::uint32_t c : flow.cells) {
    const auto at = [&](std::size_t k) { return scale * t.balls[t.cells[c][k]].center; };
    const Vec3d a = at(0), u = at(1) - a, v = at(2) - a, w = at(3) - a;
    const double whole = std::abs(dot(u, cross(v, w))) / 6;
    int outside = 0;
    for (int i = 0; i < kPoints; ++i) {
      // Three numbers in order divide the unit interval into four barycentric coordinates.
      std::array<double, 3> cut{dice.real(0, 1), dice.real(0, 1), dice.real(0, 1)};
      std::ranges::sort(cut);
      const Vec3d x = a + cut[0] * u + (cut[1] - cut[0]) * v + (cut[2] - cut[1]) * w;
      outside += std::ranges::none_of(spheres.spheres(), [&](const Sphere& s) {
        return squared_norm(x - s.center) <= s.radius * s.radius;
      });
    }
    const double share = static_cast<double>(outside) / kPoints;
    sum.volume += whole * share;
    // Nor is a share of 0 or 1 known better than to one point.
    sum.variance += whole * whole * std::max(share * (1 - share), 1.0 / kPoints) / kPoints;
  }
  return sum;
}

TEST(PocketMonteCarlo, VolumesAgree) {
  constexpr double kSigmas = 5;  // of 300 sets, one in 6000 runs would fail by chance
  std::size_t with_pockets = 0;
  Dice dice(1);
  for (unsigned seed = 1; seed <= 300; ++seed) {
    const SphereSet spheres(balls_of(seed));
    double exact = 0;
    for (const Pocket& p : pockets(spheres).pockets) exact += p.volume;
    const Counted counted = count_points(spheres, dice);
    with_pockets += exact > 0;
    EXPECT_LE(std::abs(exact - counted.volume), kSigmas * std::sqrt(counted.variance) + 1e-12)
        << "set " << seed << ": " << exact << ", counted " << counted.volume;
  }
  EXPECT_GT(with_pockets, 100u);
}

}  // namespace
}  // namespace vdwmesh::testing
