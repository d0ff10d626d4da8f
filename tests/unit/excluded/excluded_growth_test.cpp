// How the work on an excluded surface grows with the set (support/growth.hpp).
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "excluded/excluded_measures.hpp"
#include "excluded/excluded_mesher.hpp"
#include "support/ball_families.hpp"
#include "support/dice.hpp"
#include "support/growth.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kProbe = 1.4, kRadius = 1.5;
constexpr double kTouching = kProbe + kRadius;  // Å, between a probe and an atom that it touches

using MakeSet = std::function<std::vector<Sphere>(int)>;

void expect_measured(const MakeSet& atoms, int count) {
  SCOPED_TRACE("measures");
  expect_growth(count, [&](int n, Monitor& monitor) {
    const SphereSet set(atoms(n));
    EXPECT_GT(excluded_measures(set, {.probe = kProbe, .monitor = &monitor}).complete.area, 0);
  });
}

void expect_meshed(const MakeSet& atoms, int count) {
  SCOPED_TRACE("mesh");
  expect_growth(count, [&](int n, Monitor& monitor) {
    const SphereSet set(atoms(n));
    const ExcludedMesh mesh =
        mesh_excluded(set, {.probe = kProbe, .edge_length = 0.8, .monitor = &monitor});
    EXPECT_GT(mesh.mesh.triangles.size(), 0u);
  });
}

// The place of number k in a cubic lattice of `side`³.
Vec3d lattice_place(int k, int side, double apart) {
  return {apart * (k % side), apart * (k / side % side), apart * (k / side / side)};
}
int side_for(int count) { return static_cast<int>(std::ceil(std::cbrt(count) - 1e-9)); }

// Rings of six whose hole is the probe: one that touches all of them, to the last digit or nearly.
TEST(ExcludedGrowth, RingsWhoseHoleIsTheProbe) {
  const auto rings = [](int count) {
    std::vector<Sphere> out;
    for (int k = 0; k < count; ++k) {
      const Vec3d at = lattice_place(k, side_for(count), 12);
      for (int i = 0; i < 6; ++i) {
        const double turn = i * std::numbers::pi / 3;
        out.push_back({at + kTouching * Vec3d{std::cos(turn), std::sin(turn), 0}, kRadius});
      }
    }
    return out;
  };
  expect_measured(rings, 25);
}

// Cubes of eight whose hole is the probe.
TEST(ExcludedGrowth, CagesWhoseHoleIsTheProbe) {
  const auto cages = [](int count) {
    std::vector<Sphere> out;
    const double half = kTouching / std::sqrt(3.0);
    for (int k = 0; k < count; ++k) {
      const Vec3d at = lattice_place(k, side_for(count), 14);
      for (int corner = 0; corner < 8; ++corner) {
        const auto of = [&](int bit) { return (corner >> bit) % 2 == 0 ? -half : half; };
        out.push_back({at + Vec3d{of(0), of(1), of(2)}, kRadius});
      }
    }
    return out;
  };
  expect_measured(cages, 25);
  expect_meshed(cages, 16);
}

// Prisms of two squares whose sides have just the probe between them, so that it touches four.
TEST(ExcludedGrowth, PrismsWithTheProbeInEachFace) {
  const auto prisms = [](int count) {
    std::vector<Sphere> out;
    const double half = kTouching / std::sqrt(2.0);
    for (int k = 0; k < count; ++k) {
      const Vec3d at = lattice_place(k, side_for(count), 14);
      for (int i = 0; i < 8; ++i) {
        const double x = i % 2 == 0 ? -half : half, y = i / 2 % 2 == 0 ? -half : half;
        out.push_back({at + Vec3d{x, y, i < 4 ? 0 : 1.7}, kRadius});
      }
    }
    return out;
  };
  expect_measured(prisms, 25);
}

// One cage of small atoms, all of which touch the probe in the middle.
TEST(ExcludedGrowth, OneProbeThatTouchesAll) {
  const auto cage = [](int count) {
    std::vector<Sphere> out;
    constexpr double kGoldenAngle = 2.399963229728653, kSmall = 0.3;
    for (int i = 0; i < count; ++i) {
      const double z = 1 - (2 * i + 1.0) / count, wide = std::sqrt(1 - z * z);
      const Vec3d u{wide * std::cos(kGoldenAngle * i), wide * std::sin(kGoldenAngle * i), z};
      out.push_back({(kProbe + kSmall) * u, kSmall});
    }
    return out;
  };
  expect_measured(cage, 2000);
}

TEST(ExcludedGrowth, ManyChains) {
  const auto chains = [](int count) {
    Dice dice(7);
    std::vector<Sphere> out;
    constexpr int kLength = 20;
    for (int chain = 0; chain < count; ++chain) {
      const Vec3d at = lattice_place(chain, side_for(count), 8);
      for (int i = 0; i < kLength; ++i) {
        const Vec3d bend{dice.real(0, 0.2), dice.real(0, 0.2), 1.5 * i};
        out.push_back({Vec3d{at.x, at.y, 5 * at.z} + bend, 1 + dice.real(0, 0.2)});
      }
    }
    return out;
  };
  expect_measured(chains, 25);
  expect_meshed(chains, 8);
}

TEST(ExcludedGrowth, SmallAtomsOnALargeOne) {
  const auto atoms = [](int count) {
    Dice dice(30);
    const double radius = 2 * std::sqrt(count);
    std::vector<Sphere> out{{{0, 0, 0}, radius}};
    for (int i = 0; i < count; ++i) {
      out.push_back({radius * random_direction(dice), dice.real(1, 1.5)});
    }
    return out;
  };
  expect_measured(atoms, 250);
}

}  // namespace
}  // namespace vdwmesh::testing
