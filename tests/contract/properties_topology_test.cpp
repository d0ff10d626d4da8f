// Marching cubes finds the exact topology where every gap, neck, tunnel and ball is wider than 4
// spacings. Random sets of fixed seeds, each meshed at the coarsest spacing that this allows.
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "contract/extractor_contract.hpp"
#include "measures/exact_union.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

class PropertiesTopology : public ExtractorContract {};

constexpr unsigned kSets = 400;

Vec3d random_place(Dice& dice, double half) {
  return {dice.real(-half, half), dice.real(-half, half), dice.real(-half, half)};
}

std::vector<Sphere> scattered(Dice& dice) {
  const int count = dice.whole(2, 14);
  const double room = dice.real(5, 30);  // Å³ for each ball
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) {
    spheres.push_back({random_place(dice, std::cbrt(room * count) / 2), dice.real(1, 2.2)});
  }
  return spheres;
}

// Sites of a cubic lattice: bars, forks, rings and plates with wide necks between them.
std::vector<Sphere> on_sites(Dice& dice) {
  const double share = dice.real(0.4, 0.9), pitch = dice.real(2.2, 2.8), radius = 0.58 * pitch;
  std::vector<Sphere> spheres{{{0, 0, 0}, radius}};
  for (int site = 1; site < 18; ++site) {
    if (dice.real(0, 1) > share) continue;
    spheres.push_back({{pitch * (site % 3), pitch * (site / 3 % 3), pitch * (site / 9)}, radius});
  }
  return spheres;
}

// A hollow ball: one void where the lattice is dense, windows where it is not.
std::vector<Sphere> shell(Dice& dice) {
  const SphereSet set = hollow_shell(dice.whole(20, 60), dice.real(2.4, 3.6), dice.real(1.2, 1.7));
  return {set.spheres().begin(), set.spheres().end()};
}

std::vector<Sphere> ring(Dice& dice) {
  const SphereSet set = ring_of_spheres(dice.whole(5, 14), dice.real(2, 5), dice.real(0.8, 1.6));
  return {set.spheres().begin(), set.spheres().end()};
}

// Turned and moved, so that nothing lies along the grid, and shaken a little.
SphereSet placed(Dice& dice, std::vector<Sphere> spheres) {
  const double a = dice.real(0, 2 * std::numbers::pi), b = dice.real(0, 2 * std::numbers::pi);
  const Vec3d shift = random_place(dice, 1);
  for (Sphere& s : spheres) {
    const Vec3d p = s.center;
    const Vec3d q{std::cos(a) * p.x - std::sin(a) * p.y, std::sin(a) * p.x + std::cos(a) * p.y,
                  p.z};
    s.center =
        Vec3d{q.x, std::cos(b) * q.y - std::sin(b) * q.z, std::sin(b) * q.y + std::cos(b) * q.z} +
        shift + random_place(dice, 0.02);
  }
  return SphereSet(std::move(spheres));
}

SphereSet random_set(Dice& dice) {
  switch (dice.whole(0, 3)) {
    case 0:
      return placed(dice, scattered(dice));
    case 1:
      return placed(dice, on_sites(dice));
    case 2:
      return placed(dice, shell(dice));
    default:
      return placed(dice, ring(dice));
  }
}

using Betti = std::array<std::uint64_t, 3>;

// Of the balls with radii larger by `growth`, Å; nothing where a ball vanishes.
std::optional<Betti> betti(const SphereSet& spheres, double growth) {
  std::vector<Sphere> grown(spheres.spheres().begin(), spheres.spheres().end());
  for (Sphere& s : grown) {
    s.radius += growth;
    if (!(s.radius > 0)) return std::nullopt;
  }
  const UnionTopology t = *exact_union(SphereSet(std::move(grown))).topology;
  return Betti{t.components, t.tunnels, t.voids};
}

// Growing by 2 spacings fills every gap, tunnel and void up to 4 spacings wide; shrinking by 2
// takes every ball of that width and every neck, also somewhat wider ones. Where neither changes
// the topology, all are wider.
bool all_is_wide(const SphereSet& spheres, double spacing) {
  const auto here = betti(spheres, 0);
  for (const double growth : {-2.0, -1.5, -1.0, -0.5, 0.5, 1.0, 1.5, 2.0}) {
    if (betti(spheres, growth * spacing) != here) return false;
  }
  return true;
}

// Whether a point of the circle of two spheres is outside of all other balls; by 90 points.
bool is_circle_exposed(const SphereSet& spheres, std::size_t i, std::size_t j) {
  const Sphere &a = spheres[i], &b = spheres[j];
  const Vec3d between = b.center - a.center;
  const double distance = norm(between);
  const Vec3d axis = (1 / distance) * between;
  const double along = (distance + (a.radius - b.radius) * (a.radius + b.radius) / distance) / 2;
  const double radius = std::sqrt(std::max(0.0, a.radius * a.radius - along * along));
  const Vec3d aside = std::abs(axis.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = cross(axis, aside), v = cross(axis, u);
  for (int step = 0; step < 90; ++step) {
    const double angle = step * std::numbers::pi / 45;
    const Vec3d p =
        a.center + along * axis + (radius / norm(u)) * (std::cos(angle) * u + std::sin(angle) * v);
    bool exposed = true;
    for (std::size_t k = 0; k < spheres.size(); ++k) {
      if (k == i || k == j) continue;
      exposed = exposed && norm(p - spheres[k].center) > spheres[k].radius;
    }
    if (exposed) return true;
  }
  return false;
}

// Beside a crease the outside narrows to nothing, whatever the spacing; a sharp wedge there can
// hold a node of its own, and with it a void of one cell. So creases must be open by 70 degrees and
// more.
bool creases_are_open(const SphereSet& spheres) {
  const double least = std::cos(110 * std::numbers::pi / 180);  // of the cosine between the normals
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Sphere &a = spheres[i], &b = spheres[j];
      const double square = squared_norm(a.center - b.center), sum = a.radius + b.radius;
      if (square >= sum * sum) continue;
      const double cosine =
          (a.radius * a.radius + b.radius * b.radius - square) / (2 * a.radius * b.radius);
      if (cosine < least && is_circle_exposed(spheres, i, j)) return false;
    }
  }
  return true;
}

std::optional<double> coarsest_spacing(const SphereSet& spheres) {
  if (!creases_are_open(spheres)) return std::nullopt;
  for (const double spacing : {0.5, 0.4, 0.3, 0.2, 0.15, 0.1}) {
    if (all_is_wide(spheres, spacing)) return spacing;
  }
  return std::nullopt;
}

TEST_P(PropertiesTopology, WideFeaturesAreAllFound) {
  unsigned meshed = 0, with_tunnels = 0, with_voids = 0, in_pieces = 0;
  for (unsigned seed = 1; meshed < kSets; ++seed) {
    ASSERT_LT(seed, 30 * kSets) << "too few sets are wide enough";
    Dice dice(seed);
    const SphereSet spheres = random_set(dice);
    const std::optional<double> spacing = coarsest_spacing(spheres);
    if (!spacing) continue;
    ++meshed;
    const UnionTopology exact = *exact_union(spheres).topology;
    with_tunnels += exact.tunnels > 0;
    with_voids += exact.voids > 0;
    in_pieces += exact.components > 1;
    ExtractOptions options;
    options.grid.spacing = *spacing;
    const auto facts = facts_of(extract(spheres, options));
    SCOPED_TRACE(::testing::Message() << "seed " << seed << ", spacing " << *spacing);
    ASSERT_TRUE(facts.closed_oriented_manifold()) << facts.summary();
    EXPECT_EQ(facts.euler_characteristic(), exact.euler_characteristic);
    EXPECT_EQ(facts.positive_shells, exact.components);
    EXPECT_EQ(facts.negative_shells, exact.voids);
  }
  EXPECT_GT(with_tunnels, kSets / 10);
  EXPECT_GT(with_voids, kSets / 100);
  EXPECT_GT(in_pieces, kSets / 20);
}

VDWMESH_INSTANTIATE_BACKENDS(PropertiesTopology);

}  // namespace
}  // namespace vdwmesh::testing
