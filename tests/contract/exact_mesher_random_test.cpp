// Random sets of fixed seeds: every one has a sound mesh of the exact topology, before and after
// subdivision.
#include <cmath>

#include "contract/exact_mesher_contract.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

class ExactMesherRandom : public ExactMesherContract {};
VDWMESH_INSTANTIATE_BACKENDS(ExactMesherRandom);

// Å to the power of 3 for each ball: 4 is denser than a protein with its hydrogens, 40 is sparse.
struct Recipe {
  double low_radius, high_radius;  // Å
  double room;                     // Å³ for each ball
  double grid;                     // Å, of the coordinates; 0: none
};

SphereSet random_set(Dice& dice, const Recipe& recipe) {
  const int count = dice.whole(10, 60);
  const double half = std::cbrt(recipe.room * count) / 2;
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) {
    Sphere s{{dice.real(-half, half), dice.real(-half, half), dice.real(-half, half)},
             dice.real(recipe.low_radius, recipe.high_radius)};
    if (recipe.grid > 0) {
      for (int k = 0; k < 3; ++k) s.center[k] = recipe.grid * std::round(s.center[k] / recipe.grid);
      s.radius = 0.05 * std::round(20 * s.radius);
    }
    spheres.push_back(s);
  }
  return SphereSet(std::move(spheres));
}

constexpr int kSets = 30;

void expect_sound_sets(unsigned seed, const Recipe& recipe, const Demands& demands = {}) {
  for (int i = 0; i < kSets; ++i) {
    Dice dice(seed + static_cast<unsigned>(i));
    const SphereSet spheres = random_set(dice, recipe);
    const double edge_length = dice.real(0.5, 1.2);
    SCOPED_TRACE("seed " + std::to_string(seed + static_cast<unsigned>(i)) + ", edge length " +
                 std::to_string(edge_length));
    expect_union_meshes(spheres, edge_length, 1, demands);
  }
}

TEST_P(ExactMesherRandom, Dense) { expect_sound_sets(1000, {1.2, 1.9, 4, 0}); }
TEST_P(ExactMesherRandom, LikeAProtein) { expect_sound_sets(2000, {1.2, 1.9, 9, 0}); }
TEST_P(ExactMesherRandom, Sparse) { expect_sound_sets(3000, {1.0, 2.0, 40, 0}); }
TEST_P(ExactMesherRandom, EqualRadii) { expect_sound_sets(4000, {1.5, 1.5, 9, 0}); }
TEST_P(ExactMesherRandom, ManySizes) { expect_sound_sets(5000, {0.1, 2.5, 9, 0}); }
TEST_P(ExactMesherRandom, FewDecimals) { expect_sound_sets(6000, {1.2, 1.9, 9, 0.001}); }

// Coordinates and radii of one or two decimals: corners and arcs that all but coincide.
TEST_P(ExactMesherRandom, Coarse) {
  Demands demands;
  demands.distance = 3e-8;  // kNoArc of the radius, and what a collapse moves
  demands.topology = Topology::parted;
  expect_sound_sets(7000, {1.2, 1.9, 9, 0.5}, demands);
}

}  // namespace
}  // namespace vdwmesh::testing
