// Contract of distances to the exterior surface, the one without its cavities: against the complete
// surface of the same atoms with the cavity filled, and against bounds that follow from the
// definition alone (`excluded_distance.hpp`).
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "contract/excluded_distances_contract.hpp"
#include "contract/excluded_measures_contract.hpp"
#include "excluded/excluded_distances.hpp"
#include "excluded/excluded_mesher.hpp"
#include "reference/cages.hpp"
#include "reference/excluded_distance.hpp"
#include "support/ball_families.hpp"

namespace vdwmesh::testing {
namespace {

// A hollow cage of atoms shaken a little, in whose cavity a probe has room, and the same with a
// ball that fills the cavity and stays away from the outside. What lies outside of the cage is the
// same for a probe; so the exterior surface of the cage is the complete one of the filled cage.
struct HollowCage {
  HollowCage(double bond, double filler, unsigned seed) {
    Dice dice(seed);
    const SphereSet cage = equal_spheres(reference::fullerene(bond, bond), 1.5);
    for (const Sphere& s : cage.spheres()) {
      hollow.push_back({s.center + random_point(dice, 0.03), s.radius});
    }
    filled = hollow;
    filled.push_back({{0, 0, 0}, filler});
  }
  std::vector<Sphere> hollow, filled;
};

// The wall is thick enough to keep probes on both sides apart, or so thin that they overlap.
std::vector<HollowCage> hollow_cages() { return {{2.0, 3.7, 1}, {2.1, 4.1, 2}, {2.1, 4.1, 3}}; }
constexpr double kSmallProbe = 0.7;

TEST(ExteriorDistances, AreThoseOfAFilledCage) {
  Dice dice(61);
  for (const HollowCage& cage : hollow_cages()) {
    const SphereSet hollow(cage.hollow), filled(cage.filled);
    const ExcludedMeasures measures =
        excluded_measures(hollow, {.probe = kSmallProbe, .exterior = true});
    ASSERT_EQ(measures.complete.topology->components.size(), 2u);
    ASSERT_EQ(measures.exterior->topology->components.size(), 1u);
    std::vector<Vec3d> points = places_around(hollow, 2 * kSmallProbe, dice, 4000);
    for (int i = 0; i < 1000; ++i) points.push_back(random_point(dice, 5));
    for (const Sphere& s : cage.hollow) points.push_back(s.center);
    const std::vector<double> all = excluded_signed_distances(points, hollow, kSmallProbe),
                              expected = excluded_signed_distances(points, filled, kSmallProbe),
                              found = excluded_signed_distances(points, hollow, kSmallProbe,
                                                                nullptr, ExcludedPart::exterior);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_NEAR(found[i], expected[i], kRounding) << points[i].x << ", " << points[i].y;
      changed += std::abs(all[i] - found[i]) > 0.1;
    }
    EXPECT_GT(changed, points.size() / 10);
    const reference::ExcludedDistance oracle(reference_balls(filled), kSmallProbe);
    for (std::size_t i = 0; i < points.size(); i += 400) {
      const Vec3d& p = points[i];
      const auto [lower, upper] = oracle.bounds({{p.x, p.y, p.z}}, 0.02);
      EXPECT_TRUE(found[i] >= lower - kSlack && found[i] <= upper + kSlack);
    }
  }
}

// Atoms that touch no other, one outside of the cage and one in its cavity. From a centre all
// points of the sphere are equally near, and there is no arc on it.
TEST(ExteriorDistances, FromTheCentreOfAnAtomAlone) {
  const Sphere outside{{20, 1, -2}, 1.7}, inside{{0.1, 0, 0.2}, 1};
  for (const HollowCage& cage : hollow_cages()) {
    std::vector<Sphere> hollow = cage.hollow, filled = cage.filled;
    hollow.insert(hollow.end(), {outside, inside});
    filled.push_back(outside);
    const std::vector<Vec3d> centers = {outside.center, inside.center};
    const std::vector<double> expected =
        excluded_signed_distances(centers, SphereSet(filled), kSmallProbe);
    const std::vector<double> found = excluded_signed_distances(
        centers, SphereSet(hollow), kSmallProbe, nullptr, ExcludedPart::exterior);
    EXPECT_NEAR(found[0], -outside.radius, kRounding);
    EXPECT_NEAR(found[0], expected[0], kRounding);
    EXPECT_LT(found[1], -3);
    EXPECT_NEAR(found[1], expected[1], kRounding);
  }
}

// Samples on the exterior surface alone, and all of them: their mean distance from a speck is that
// of the filled cage, inside as well as outside.
TEST(ExteriorDistances, SamplesAreOnTheExteriorSurface) {
  for (const HollowCage& cage : hollow_cages()) {
    const SphereSet hollow(cage.hollow), filled(cage.filled);
    DistanceOptions options;
    options.samples_per_area = 60;
    for (const Vec3d& at : {Vec3d{0, 0, 0}, Vec3d{0, 12, 3}}) {
      const MeshDistances expected = excluded_distances(speck_at(at), filled, kSmallProbe, options);
      const MeshDistances found =
          excluded_distances(speck_at(at), hollow, kSmallProbe, options, ExcludedPart::exterior);
      const DistanceStatistics &a = found.surface_to_mesh, &b = expected.surface_to_mesh;
      EXPECT_NEAR(a.mean, b.mean, 5 * (a.mean_error + b.mean_error) + 1e-4);
      EXPECT_NEAR(a.max, b.max, 0.05);
      EXPECT_NEAR(static_cast<double>(a.samples), static_cast<double>(b.samples),
                  0.02 * static_cast<double>(b.samples));
      EXPECT_NEAR(found.mesh_to_surface.mean, expected.mesh_to_surface.mean, kRounding);
    }
    // The walls of the cavity are far from the exterior mesh, which the complete surface shows.
    ExcludedMeshOptions coarse;
    coarse.probe = kSmallProbe;
    coarse.edge_length = 0.7;
    const IndexedMesh mesh = mesh_excluded(filled, coarse).mesh;
    const auto farthest = [&](ExcludedPart part) {
      return excluded_distances(mesh, hollow, kSmallProbe, {}, part).surface_to_mesh.max;
    };
    EXPECT_LT(farthest(ExcludedPart::exterior), 0.25);
    EXPECT_GT(farthest(ExcludedPart::complete), 1.0);
  }
}

}  // namespace
}  // namespace vdwmesh::testing
