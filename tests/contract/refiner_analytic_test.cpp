// Subdivision with projection on spheres, whose area and volume are known.
#include <cmath>
#include <numbers>

#include "contract/refiner_contract.hpp"
#include "reference/closed_forms.hpp"

namespace vdwmesh::testing {
namespace {

class RefinerAnalytic : public RefinerContract {};

struct Errors {
  double area, volume;  // relative, positive where the mesh falls short
};

Errors errors(const IndexedMesh& mesh, const reference::Measures& exact) {
  const reference::MeshFacts facts = facts_of(mesh);
  EXPECT_TRUE(facts.closed_oriented_manifold()) << facts.summary();
  return {1 - facts.area / exact.area, 1 - facts.volume / exact.volume};
}

// Halving the edges of a mesh inscribed in a smooth surface divides both errors by 4, up to terms
// of the fourth order: from 512 triangles on the ratio is within 5 % of 4.
constexpr double kOrderTwo = 4, kOrderTwoSlack = 0.2;
constexpr std::size_t kAsymptotic = 512;  // triangles per sphere
constexpr double kRadius = 1.7;           // Å

class RefinerConvergence : public RefinerAnalytic {
 protected:
  void expect_order_two(const SphereSet& spheres, const IndexedMesh& mesh, int levels,
                        const reference::Measures& exact, std::size_t asymptotic) const {
    Errors last{0, 0};
    for (int level = 0; level <= levels; ++level) {
      const RefineResult result = refine(spheres, mesh, refine_options(level, Projection::vdw));
      EXPECT_EQ(left_out(result), 0u);
      const Errors now = errors(result.mesh, exact);
      if (last.area != 0) {
        EXPECT_NEAR(last.area / now.area, kOrderTwo, kOrderTwoSlack) << "level " << level;
        EXPECT_NEAR(last.volume / now.volume, kOrderTwo, kOrderTwoSlack) << "level " << level;
      }
      if (result.mesh.triangle_count() >= asymptotic) last = now;
    }
    ASSERT_NE(last.area, 0) << "too few levels";
  }
};

TEST_P(RefinerConvergence, Octahedron) {
  expect_order_two(one_sphere(kRadius), octahedron(), 6, reference::ball(kRadius), kAsymptotic);
}

TEST_P(RefinerConvergence, Icosahedron) {
  expect_order_two(one_sphere(kRadius), icosahedron(), 5, reference::ball(kRadius), kAsymptotic);
}

TEST_P(RefinerConvergence, TwoDisjointOctahedra) {
  const SphereSet spheres = spheres_of({{{0, 0, 0}, 1.5}, {{5, 1, 2}, 1.5}});
  const IndexedMesh mesh = together(octahedron(), translated(octahedron(), {5, 1, 2}));
  expect_order_two(spheres, mesh, 6, reference::two_balls(1.5, 1.5, std::sqrt(30.0)),
                   2 * kAsymptotic);
}

TEST_P(RefinerConvergence, MarchingCubesOfOneSphere) {
  const SphereSet spheres = one_sphere(kRadius);
  expect_order_two(spheres, marching_cubes(spheres, 0.5).mesh, 4, reference::ball(kRadius),
                   kAsymptotic);
}

TEST_P(RefinerConvergence, MarchingCubesOfTwoDisjointSpheres) {
  const SphereSet spheres = two_spheres(1.7, 1.2, 4);
  expect_order_two(spheres, marching_cubes(spheres, 0.5).mesh, 4, reference::two_balls(1.7, 1.2, 4),
                   2 * kAsymptotic);
}

// The crease is cut, so the area error is of first order in the end: the ratio is below 4.
TEST_P(RefinerAnalytic, TwoOverlappingSpheresLoseTheOrderAtTheCrease) {
  const SphereSet spheres = two_spheres(1.7, 1.5, 1.9);
  const reference::Measures exact = reference::two_balls(1.7, 1.5, 1.9);
  const IndexedMesh mesh = marching_cubes(spheres, 0.5).mesh;
  double last = 0;
  for (int level = 0; level <= 4; ++level) {
    const RefineResult result = refine(spheres, mesh, refine_options(level, Projection::vdw));
    const Errors now = errors(result.mesh, exact);
    EXPECT_GT(now.area, 0);
    if (last != 0) {
      RecordProperty("area_error_ratio_" + std::to_string(level), std::to_string(last / now.area));
      EXPECT_GT(last / now.area, 1);
      EXPECT_LT(last / now.area, kOrderTwo - kOrderTwoSlack);
    }
    last = now.area;
  }
}

// Every normal is the outward normal of the sphere, to the rounding of float (2^-24 per component).
constexpr double kNormalTolerance = 2e-7;

TEST_P(RefinerAnalytic, NormalsAreThoseOfTheSphere) {
  const RefineResult result =
      refine(one_sphere(kRadius), icosahedron(), refine_options(3, Projection::vdw));
  ASSERT_EQ(result.mesh.normals.size(), result.mesh.vertex_count());
  for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
    const Vec3d exact = (1 / kRadius) * result.mesh.positions[v];
    EXPECT_LE(norm(cast<double>(result.mesh.normals[v]) - exact), kNormalTolerance);
  }
}

// A blended field of one atom has the atom's sphere as its isosurface.
class RefinerFieldAnalytic : public RefinerFieldContract {};

TEST_P(RefinerFieldAnalytic, OneAtomIsItsSphere) {
  const SphereSet spheres = one_sphere(kRadius);
  const ExtractResult extracted = marching_cubes(spheres, 0.4, kind());
  Errors last{0, 0};
  for (int level = 0; level <= 3; ++level) {
    const RefineResult result =
        refine(spheres, extracted.mesh, field_options(level, kind(), extracted.grid));
    EXPECT_EQ(left_out(result), 0u);
    for (const Vec3d& p : result.mesh.positions) {
      ASSERT_LE(std::abs(norm(p) - kRadius), 2 * kProjectionTolerance);
    }
    const Errors now = errors(result.mesh, reference::ball(kRadius));
    if (last.area != 0) {
      EXPECT_NEAR(last.area / now.area, kOrderTwo, kOrderTwoSlack) << "level " << level;
      EXPECT_NEAR(last.volume / now.volume, kOrderTwo, kOrderTwoSlack) << "level " << level;
    }
    if (result.mesh.triangle_count() >= kAsymptotic) last = now;
  }
}

VDWMESH_INSTANTIATE_BACKENDS(RefinerAnalytic);
VDWMESH_INSTANTIATE_BACKENDS(RefinerConvergence);
VDWMESH_INSTANTIATE_BLENDED_FIELDS(RefinerFieldAnalytic);

}  // namespace
}  // namespace vdwmesh::testing
