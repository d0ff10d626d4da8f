// Triangles with vertices of their own become a mesh again.
#include "mesh/connect/weld.hpp"

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

IndexedMesh corner_by_corner(const IndexedMesh& mesh) {
  IndexedMesh soup;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertex_count());
    for (const std::uint32_t v : t) soup.positions.push_back(mesh.positions[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

TEST(Welded, IsTheMeshThatWasTakenApart) {
  for (const testing::KnownMesh& known : testing::known_meshes()) {
    if (known.name == "sharing_vertex" || known.name == "sharing_edge") continue;
    const IndexedMesh soup = corner_by_corner(known.mesh);
    const IndexedMesh mesh = welded(soup);
    EXPECT_EQ(mesh.vertex_count(), known.mesh.vertex_count()) << known.name;
    ASSERT_EQ(mesh.triangle_count(), known.mesh.triangle_count());
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(mesh.positions[mesh.triangles[t][k]],
                  known.mesh.positions[known.mesh.triangles[t][k]]);
  }
}

TEST(Welded, KeepsTheFirstLabel) {
  IndexedMesh soup = corner_by_corner(testing::tetrahedron());
  for (SphereId v = 0; v < soup.vertex_count(); ++v) soup.vertex_spheres.atoms.push_back(v);
  soup.triangle_spheres.assign(4, 5);
  const IndexedMesh mesh = welded(soup);
  EXPECT_EQ(mesh.vertex_spheres.atoms, (Buffer<SphereId>{0, 1, 2, 5}));
  EXPECT_EQ(mesh.triangle_spheres, soup.triangle_spheres);
}

TEST(Welded, LeavesNeighboursApart) {
  IndexedMesh mesh =
      testing::make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}}, {{3, 1, 2}});
  mesh.positions.push_back({0, 0, 1e-300});
  EXPECT_EQ(welded(mesh).vertex_count(), 4u);  // -0 is 0
  EXPECT_EQ(welded(mesh).triangles[0], (Triangle{0, 1, 2}));
  mesh.triangles[0][1] = 9;
  EXPECT_THROW(welded(mesh), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh
