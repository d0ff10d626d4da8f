// Projection must not spoil the mesh: no triangle turned, no two crossing, and every move taken
// back counted. Crossings are counted by CGAL's exact predicates.
#include <array>
#include <cmath>

#include "analysis/mesh_measures.hpp"
#include "contract/refiner_contract.hpp"

namespace vdwmesh::testing {
namespace {

class RefinerQuality : public RefinerContract {};
class RefinerFieldQuality : public RefinerFieldContract {};

// Molecule-like clusters have creases of every angle: plain projection makes hundreds of crossings.
TEST_P(RefinerQuality, NoTwoTrianglesCross) {
  std::uint64_t undone = 0;
  for (const unsigned seed : {31u, 32u, 33u}) {
    const SphereSet spheres = cluster(120, seed);
    const IndexedMesh mesh = marching_cubes(spheres, 0.5).mesh;
    ASSERT_EQ(self_intersections(mesh), 0u);
    const RefineResult result = refine(spheres, mesh, refine_options(2, Projection::vdw));
    EXPECT_EQ(self_intersections(result.mesh), 0u) << "seed " << seed;
    for (const ProjectionStats& s : result.levels) undone += s.undone;
  }
  EXPECT_GT(undone, 0u);
}

TEST_P(RefinerFieldQuality, NoTwoTrianglesCross) {
  const SphereSet spheres = cluster(60, 34);
  const ExtractResult extracted = marching_cubes(spheres, 0.5, kind());
  const RefineResult result =
      refine(spheres, extracted.mesh, field_options(2, kind(), extracted.grid));
  EXPECT_EQ(self_intersections(result.mesh), self_intersections(extracted.mesh));
}

TEST_P(RefinerQuality, AMeshPulledFromABlendedSurfaceDoesNotCross) {
  const SphereSet spheres = cluster(60, 35);
  const IndexedMesh mesh = marching_cubes(spheres, 0.4, FieldKind::soft_object).mesh;
  const RefineResult result = refine(spheres, mesh, refine_options(1, Projection::vdw));
  EXPECT_EQ(self_intersections(result.mesh), 0u);
}

double facing_sum(const std::array<Vec3d, 3>& p, const Vec3d& center) {
  const Vec3d area = cross(p[1] - p[0], p[2] - p[0]);
  return dot(area, (1.0 / 3) * (p[0] + p[1] + p[2]) - center);
}

// A child is turned only where the flat child of the same parent was. In these clusters a triangle
// would turn without crossing another.
TEST_P(RefinerQuality, NoTriangleOfOneAtomIsTurned) {
  for (const unsigned seed : {13u, 14u, 45u}) {
    const SphereSet spheres = cluster(120, seed);
    const IndexedMesh mesh = marching_cubes(spheres, 0.5).mesh;
    const IndexedMesh flat = refine(spheres, mesh, refine_options(1, Projection::none)).mesh;
    const IndexedMesh moved = refine(spheres, mesh, refine_options(1, Projection::vdw)).mesh;
    ASSERT_EQ(flat.triangles, moved.triangles);
    for (const Triangle& t : moved.triangles) {
      const SphereId atom = moved.vertex_spheres.atoms[t[0]];
      if (moved.vertex_spheres.atoms[t[1]] != atom || moved.vertex_spheres.atoms[t[2]] != atom)
        continue;
      const auto corners = [&](const IndexedMesh& m) {
        return std::array<Vec3d, 3>{m.positions[t[0]], m.positions[t[1]], m.positions[t[2]]};
      };
      if (facing_sum(corners(moved), spheres[atom].center) >= 0) continue;
      EXPECT_LT(facing_sum(corners(flat), spheres[atom].center), 0) << "seed " << seed;
    }
  }
}

VDWMESH_INSTANTIATE_BACKENDS(RefinerQuality);
VDWMESH_INSTANTIATE_BLENDED_FIELDS(RefinerFieldQuality);

}  // namespace
}  // namespace vdwmesh::testing
