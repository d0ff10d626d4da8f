// What no choice of origin, order or spacing may change.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "contract/extractor_contract.hpp"

namespace vdwmesh::testing {
namespace {

class ExtractorFieldInvariant : public ExtractorFieldContract {};

TEST_P(ExtractorFieldInvariant, EveryClusterIsClosedOrientedAndManifold) {
  for (const int count : {3, 20, 150}) {
    for (const double h : {0.31, 0.5, 0.87}) {
      for (unsigned seed = 1; seed <= 3; ++seed) {
        expect_sound(extract(cluster(count, seed), at_spacing(h)),
                     std::to_string(count) + " spheres at " + std::to_string(h));
      }
    }
  }
}

TEST_P(ExtractorFieldInvariant, NormalsAreUnitAndPointOutwards) {
  const ExtractResult result = extract(cluster(60, 5), at_spacing(0.4));
  const IndexedMesh& mesh = result.mesh;
  std::size_t outwards = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    const Vec3d sum = cast<double>(mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]]);
    outwards += dot(cross(b - a, c - a), sum) > 0;
  }
  for (const Vec3f& n : mesh.normals) ASSERT_NEAR(norm(cast<double>(n)), 1, 1e-6);
  // Across creases a triangle may face away from one of the spheres of its corners.
  EXPECT_GT(outwards, mesh.triangle_count() * 97 / 100);
}

// Coordinates at 5000 Å are good to 1e-12 Å, which changes no number by more than a hair; but a
// node whose field sits at the isovalue may change sides.
constexpr double kTranslationTolerance = 1e-6;  // relative

TEST_P(ExtractorFieldInvariant, TranslationChangesNothing) {
  const SphereSet spheres = cluster(80, 11);
  const auto here = facts_of(extract(spheres, at_spacing(0.45)));
  const ExtractResult moved = extract(translated(spheres, {5000, -5000, 5000}), at_spacing(0.45));
  expect_sound(moved, "translated by 5000 Å");
  const auto there = facts_of(moved);
  EXPECT_NEAR(there.area / here.area, 1, kTranslationTolerance);
  EXPECT_NEAR(there.volume / here.volume, 1, kTranslationTolerance);
  EXPECT_EQ(there.euler_characteristic(), here.euler_characteristic());
  EXPECT_EQ(there.triangles, here.triangles);
}

TEST_P(ExtractorFieldInvariant, PermutedAtomsGiveTheSameMeshWithPermutedLabels) {
  // The ring has exact ties between its spheres, the cluster has none.
  for (const SphereSet& spheres :
       {cluster(120, 3), ring_of_spheres(8, 3, 1.6),
        SphereSet({{{-1, 0, 0}, 1.5}, {{1, 0, 0}, 1.5}, {{0, -1, 0}, 1.5}, {{0, 1, 0}, 1.5}})}) {
    std::vector<SphereId> order(spheres.size());
    std::iota(order.begin(), order.end(), SphereId{0});
    std::shuffle(order.begin(), order.end(), std::mt19937(17));
    const ExtractOptions options = at_spacing(0.5);
    expect_permuted(spheres, extract(spheres, options), extract(permuted(spheres, order), options),
                    order);
  }
}

VDWMESH_INSTANTIATE_FIELDS(ExtractorFieldInvariant);

}  // namespace
}  // namespace vdwmesh::testing
