// Edge lengths by sphere: closed forms for two balls, and random sets whose lengths are far apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "contract/exact_mesher_contract.hpp"
#include "core/errors.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

class ExactMesherGraded : public ExactMesherContract {};
VDWMESH_INSTANTIATE_BACKENDS(ExactMesherGraded);

ExactMesh graded_mesh(const SphereSet& spheres, const std::vector<double>& lengths) {
  ExactMeshOptions options;
  options.edge_length = std::numeric_limits<double>::quiet_NaN();  // has no effect beside lengths
  options.edge_lengths = lengths;
  return mesh_with(spheres, options);
}

SphereSet cluster_of(Dice& dice, int count) {
  const double half = std::cbrt(9.0 * count) / 2;  // as dense as a protein
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) {
    spheres.push_back({{dice.real(-half, half), dice.real(-half, half), dice.real(-half, half)},
                       dice.real(1.2, 1.9)});
  }
  return SphereSet(spheres);
}

TEST_P(ExactMesherGraded, EqualLengthsAreOneLength) {
  Dice dice(1);
  for (const SphereSet& spheres : {cluster_of(dice, 40), SphereSet({{{0, 0, 0}, 1}}),
                                   SphereSet({{{0, 0, 0}, 1}, {{0, 0, 0}, 1}, {{1, 0, 0}, 0.5}})}) {
    EXPECT_EQ(hash(graded_mesh(spheres, std::vector<double>(spheres.size(), 0.4)).mesh),
              hash(mesh_at(spheres, 0.4).mesh));
  }
}

// Two unit balls at distance 1 meet in a circle of radius √3/2. The shorter of two lengths divides
// it, whichever ball has it.
TEST_P(ExactMesherGraded, TheShorterLengthDividesTheArc) {
  const SphereSet spheres({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}});
  const double circle = std::sqrt(3.0) * std::numbers::pi;
  for (const double fine : {0.05, 0.1, 0.2}) {
    const auto pieces = static_cast<std::uint64_t>(std::ceil(circle / fine));
    EXPECT_EQ(graded_mesh(spheres, {fine, 0.8}).stats.pieces, pieces);
    EXPECT_EQ(graded_mesh(spheres, {0.8, fine}).stats.pieces, pieces);
  }
}

// The triangles of an exposed ball far from the arc have its own length: their number is that of
// equilateral triangles of its area, as with one length for all.
TEST_P(ExactMesherGraded, EachBallHasTrianglesOfItsLength) {
  const SphereSet apart({{{0, 0, 0}, 1}, {{5, 0, 0}, 1}, {{0, 5, 0}, 2}});
  const std::vector<double> lengths{0.1, 0.4, 0.2};
  const IndexedMesh mesh = graded_mesh(apart, lengths).mesh;
  for (SphereId id = 0; id < 3; ++id) {
    const SphereSet alone({apart[id]});
    EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(mesh.triangle_spheres, id)),
              mesh_at(alone, lengths[id]).mesh.triangle_count());
  }
}

// A ball of long edges beside one of short ones: the number of its triangles is far below that of
// short edges everywhere.
TEST_P(ExactMesherGraded, TrianglesGrowAwayFromAFineArc) {
  const SphereSet spheres({{{0, 0, 0}, 1}, {{2, 0, 0}, 2}});
  const IndexedMesh mesh = graded_mesh(spheres, {0.03, 0.8}).mesh;
  const auto of_large = std::ranges::count(mesh.triangle_spheres, SphereId{1});
  const auto all_fine =
      std::ranges::count(mesh_at(spheres, 0.03).mesh.triangle_spheres, SphereId{1});
  EXPECT_LT(10 * of_large, all_fine);
  expect_union_mesh(spheres, mesh, exact_union(spheres), {});
}

TEST_P(ExactMesherGraded, RandomSets) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(9000 + seed);
    const SphereSet spheres = cluster_of(dice, dice.whole(2, 40));
    std::vector<double> lengths;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      lengths.push_back(std::exp(dice.real(std::log(0.05), std::log(2.0))));
    }
    const IndexedMesh mesh = graded_mesh(spheres, lengths).mesh;
    const ExactUnion exact = exact_union(spheres);
    expect_union_mesh(spheres, mesh, exact, {});
    expect_union_mesh(spheres, subdivided(spheres, mesh, 1), exact, {});
    // At most one angle in a hundred is below 15°, as with one length for all.
    const std::vector<float> angles = min_angles_deg(mesh);
    const auto sharp = std::ranges::count_if(angles, [](float a) { return a < 15; });
    EXPECT_LT(100 * sharp, static_cast<std::ptrdiff_t>(angles.size()));
  }
}

// The lengths go with their spheres, whatever their order.
TEST_P(ExactMesherGraded, PermutedSpheresAndLengths) {
  Dice dice(5);
  const SphereSet spheres = cluster_of(dice, 30);
  std::vector<double> lengths;
  for (std::size_t i = 0; i < spheres.size(); ++i) lengths.push_back(dice.real(0.1, 0.9));
  std::vector<Sphere> turned(spheres.spheres().begin(), spheres.spheres().end());
  std::vector<double> turned_lengths = lengths;
  std::ranges::reverse(turned), std::ranges::reverse(turned_lengths);
  const IndexedMesh one = graded_mesh(spheres, lengths).mesh;
  const IndexedMesh two = graded_mesh(SphereSet(turned), turned_lengths).mesh;
  EXPECT_EQ(one.positions, two.positions);
  EXPECT_EQ(one.triangles, two.triangles);
}

TEST_P(ExactMesherGraded, LengthsThatAreNone) {
  const SphereSet spheres({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}});
  EXPECT_THROW(graded_mesh(spheres, {0.3}), InvalidInput);
  EXPECT_THROW(graded_mesh(spheres, {0.3, 0.3, 0.3}), InvalidInput);
  for (const double wrong : {0.0, -0.3, std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(graded_mesh(spheres, {0.3, wrong}), InvalidInput);
  }
}

// The estimate counts each sphere with its own length.
TEST_P(ExactMesherGraded, TooFineIsRefusedBeforeMemoryIsTaken) {
  ExactMeshOptions options;
  const std::vector<double> lengths{0.3, 1e-5};
  options.edge_lengths = lengths;
  options.memory_limit = std::uint64_t{1} << 30;
  EXPECT_THROW(mesh_with(SphereSet({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}}), options), LimitExceeded);
}

}  // namespace
}  // namespace vdwmesh::testing
