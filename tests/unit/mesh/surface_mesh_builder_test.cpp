#include "mesh/surface_mesh_builder.hpp"

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

using testing::KnownMesh;

MeshSize size_of(const IndexedMesh& mesh) { return {mesh.vertex_count(), mesh.triangle_count()}; }

// All that links one element to another, all of their data.
void expect_equal(const SurfaceMesh& a, const SurfaceMesh& b) {
  ASSERT_EQ(a.n_vertices(), b.n_vertices());
  ASSERT_EQ(a.n_halfedges(), b.n_halfedges());
  ASSERT_EQ(a.n_faces(), b.n_faces());
  for (const auto h : a.halfedges()) {
    ASSERT_EQ(a.to_vertex_handle(h), b.to_vertex_handle(h));
    ASSERT_EQ(a.next_halfedge_handle(h), b.next_halfedge_handle(h));
    ASSERT_EQ(a.prev_halfedge_handle(h), b.prev_halfedge_handle(h));
    ASSERT_EQ(a.face_handle(h), b.face_handle(h));
  }
  for (const auto f : a.faces()) ASSERT_EQ(a.halfedge_handle(f), b.halfedge_handle(f));
  const VertexSpheresProperty spheres_a = vertex_spheres(a), spheres_b = vertex_spheres(b);
  for (const auto v : a.vertices()) {
    ASSERT_EQ(a.halfedge_handle(v), b.halfedge_handle(v));
    ASSERT_EQ(a.point(v), b.point(v));
    ASSERT_EQ(a.normal(v), b.normal(v));
    ASSERT_EQ(a.color(v), b.color(v));
    ASSERT_EQ(a.property(spheres_a, v), b.property(spheres_b, v));
  }
}

class PreparedSurface : public ::testing::TestWithParam<KnownMesh> {
 protected:
  // The mesh, built after room for `size` was made.
  void expect_built_as_ever(const MeshSize& size) {
    SurfaceMesh mesh;
    SurfaceMeshBuilder builder(mesh);
    builder.prepare(size);
    EXPECT_EQ(&builder.build(GetParam().mesh), &mesh);
    expect_equal(mesh, to_surface_mesh(GetParam().mesh));
  }
};

TEST_P(PreparedSurface, IsTheSame) { expect_built_as_ever(size_of(GetParam().mesh)); }

// The size is a hint: edges of a boundary, for one, are not in it.
TEST_P(PreparedSurface, IsTheSameFromAWrongSize) {
  const auto [vertices, triangles] = size_of(GetParam().mesh);
  expect_built_as_ever({0, 0});
  expect_built_as_ever({vertices / 2, triangles / 2});
  expect_built_as_ever({2 * vertices, 3 * triangles});
}

std::vector<KnownMesh> small_and_large() {
  std::vector<KnownMesh> meshes = testing::known_half_edge_meshes();
  meshes.push_back({"large_torus", testing::torus(150, 90), true, true, true, 1, 0, 1});
  return meshes;
}

INSTANTIATE_TEST_SUITE_P(All, PreparedSurface, ::testing::ValuesIn(small_and_large()),
                         [](const auto& info) { return info.param.name; });

TEST(SurfaceMeshBuilder, NeedNotBuildWhatItPrepared) {
  SurfaceMesh mesh;
  SurfaceMeshBuilder(mesh).prepare({100'000, 200'000});
}

TEST(SurfaceMeshBuilder, PreparesOnce) {
  const IndexedMesh source = testing::torus(150, 90);
  SurfaceMesh mesh;
  SurfaceMeshBuilder builder(mesh);
  builder.prepare(size_of(source));
  builder.prepare({1, 1});
  builder.prepare(size_of(source));
  expect_equal(builder.build(source), to_surface_mesh(source));
}

TEST(SurfaceMeshBuilder, RefusesToPrepareMoreThanHandlesCanName) {
  SurfaceMesh mesh;
  SurfaceMeshBuilder builder(mesh);
  EXPECT_THROW(builder.prepare({10, 0x7fffffffu / 3 + 1}), LimitExceeded);
  EXPECT_THROW(builder.prepare({0x80000000u, 10}), LimitExceeded);
}

}  // namespace
}  // namespace vdwmesh
