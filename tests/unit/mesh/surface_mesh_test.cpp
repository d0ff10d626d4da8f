#include "mesh/surface_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <OpenMesh/Tools/Utils/MeshCheckerT.hh>
#include <set>
#include <sstream>

#include "core/errors.hpp"
#include "mesh/element_color.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

using ::testing::HasSubstr;
using testing::KnownMesh;

// What OpenMesh itself and its documentation ask of a mesh.
void expect_openmesh_invariants(const SurfaceMesh& mesh) {
  std::ostringstream complaints;
  EXPECT_TRUE(OpenMesh::Utils::MeshCheckerT<SurfaceMesh>(mesh).check(
      OpenMesh::Utils::MeshCheckerT<SurfaceMesh>::CHECK_ALL, complaints))
      << complaints.str();
  for (const auto h : mesh.halfedges()) {
    ASSERT_TRUE(h.next().is_valid() && h.prev().is_valid());
    EXPECT_EQ(h.next().prev(), h);
    EXPECT_EQ(h.prev().next(), h);
    EXPECT_EQ(h.to(), h.next().from());
    EXPECT_EQ(h.opp().opp(), h);
    EXPECT_EQ(h.from(), h.opp().to());
    EXPECT_EQ(h.face(), h.next().face()) << "a half-edge and its next lie on one side";
    EXPECT_FALSE(h.is_boundary() && h.opp().is_boundary());
  }
  for (const auto v : mesh.vertices()) {
    if (mesh.is_isolated(v)) continue;
    EXPECT_EQ(v.halfedge().from(), v);
    bool touches_boundary = false;
    for (const auto h : v.outgoing_halfedges()) touches_boundary |= h.is_boundary();
    EXPECT_EQ(v.halfedge().is_boundary(), touches_boundary);
  }
  for (const auto f : mesh.faces()) EXPECT_EQ(f.halfedge().face(), f);
}

std::string refusal(const IndexedMesh& mesh) {
  try {
    to_surface_mesh(mesh);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

class KnownSurface : public ::testing::TestWithParam<KnownMesh> {};

TEST_P(KnownSurface, IsBuilt) {
  const KnownMesh& known = GetParam();
  const SurfaceMesh mesh = to_surface_mesh(known.mesh);
  expect_openmesh_invariants(mesh);
  EXPECT_EQ(mesh.n_vertices(), known.mesh.vertex_count());
  EXPECT_EQ(mesh.n_faces(), known.mesh.triangle_count());
  EXPECT_EQ(static_cast<std::int64_t>(mesh.n_vertices()) -
                static_cast<std::int64_t>(mesh.n_edges()) +
                static_cast<std::int64_t>(mesh.n_faces()),
            known.euler_characteristic);
  bool has_boundary = false;
  for (const auto h : mesh.halfedges()) has_boundary |= h.is_boundary();
  EXPECT_EQ(!has_boundary, known.closed);
}

TEST_P(KnownSurface, ComesBackAsItWas) {
  const KnownMesh& known = GetParam();
  const IndexedMesh back = to_indexed_mesh(to_surface_mesh(known.mesh));
  EXPECT_EQ(back.positions, known.mesh.positions);
  EXPECT_EQ(back.triangles, known.mesh.triangles);
  EXPECT_EQ(back.opposite, opposite_half_edges(known.mesh.triangles, known.mesh.vertex_count()));
}

TEST_P(KnownSurface, IsTheSameFromGivenOpposites) {
  const KnownMesh& known = GetParam();
  IndexedMesh given = known.mesh;
  given.opposite = opposite_half_edges(given.triangles, given.vertex_count());
  const SurfaceMesh a = to_surface_mesh(known.mesh), b = to_surface_mesh(given);
  for (const auto h : a.halfedges()) {
    EXPECT_EQ(h.to().idx(), b.to_vertex_handle(h).idx());
    EXPECT_EQ(h.next().idx(), b.next_halfedge_handle(h).idx());
  }
}

INSTANTIATE_TEST_SUITE_P(All, KnownSurface, ::testing::ValuesIn(testing::known_half_edge_meshes()),
                         [](const auto& info) { return info.param.name; });

TEST(SurfaceMesh, NumbersEdgesByFirstOccurrence) {
  const SurfaceMesh mesh = to_surface_mesh(testing::icosphere(2));
  int expected = 0;
  std::set<int> seen;
  for (const auto f : mesh.faces())
    for (const auto h : f.halfedges())
      if (seen.insert(h.edge().idx()).second) {
        EXPECT_EQ(h.edge().idx(), expected++);
        EXPECT_EQ(h.idx() % 2, 0) << "the first of the two half-edges is the even one";
      }
  EXPECT_EQ(static_cast<std::size_t>(expected), mesh.n_edges());
}

TEST(SurfaceMesh, KeepsVertexData) {
  IndexedMesh source = testing::tetrahedron();
  for (std::uint32_t v = 0; v < 4; ++v) {
    source.normals.push_back({static_cast<float>(v), 0, 1});
    source.vertex_spheres.push_back({v, v == 2 ? 7 : kNoSphere, kNoSphere});
  }
  const SurfaceMesh mesh = to_surface_mesh(source);
  const IndexedMesh back = to_indexed_mesh(mesh);
  EXPECT_EQ(back.normals, source.normals);
  EXPECT_EQ(back.vertex_spheres, source.vertex_spheres);
  EXPECT_EQ(mesh.property(vertex_spheres(mesh), OpenMesh::VertexHandle(2))[1], 7u);
}

TEST(SurfaceMesh, WithDeletedFacesIsNoIndexedMeshUntilTheyAreCollected) {
  SurfaceMesh mesh = to_surface_mesh(testing::icosphere(1));
  const std::size_t faces = mesh.n_faces();
  mesh.delete_face(OpenMesh::FaceHandle(3));
  EXPECT_THROW(to_indexed_mesh(mesh), InvalidInput);
  mesh.garbage_collection();
  EXPECT_EQ(to_indexed_mesh(mesh).triangle_count(), faces - 1);
}

TEST(SurfaceMesh, KeepsTheSpheresOfFacesWhereThereAreAny) {
  IndexedMesh source = testing::tetrahedron();
  EXPECT_FALSE(face_spheres(to_surface_mesh(source)));
  EXPECT_TRUE(to_indexed_mesh(to_surface_mesh(source)).triangle_spheres.empty());
  source.triangle_spheres = {5, 0, 7, 5};
  const SurfaceMesh mesh = to_surface_mesh(source);
  ASSERT_TRUE(face_spheres(mesh));
  EXPECT_EQ(mesh.property(*face_spheres(mesh), OpenMesh::FaceHandle(2)), 7u);
  EXPECT_EQ(to_indexed_mesh(mesh).triangle_spheres, source.triangle_spheres);
  source.triangle_spheres.pop_back();
  EXPECT_THROW(to_surface_mesh(source), InvalidInput);
}

constexpr float kRounding = 1e-6f;  // of unit float vectors

TEST(SurfaceMesh, TakesNormalsFromTrianglesWhereNoneAreGiven) {
  const SurfaceMesh mesh = to_surface_mesh(testing::octahedron());
  for (const auto v : mesh.vertices())
    for (unsigned axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(mesh.normal(v)[axis], static_cast<float>(mesh.point(v)[axis]), kRounding);
}

// Triangles count by their area. Around the right-angled corner of a tetrahedron with legs 1, 2, 3
// the area vectors are -(2·3, 1·3, 1·2) / 2, of length 7 / 2 together.
TEST(SurfaceMesh, WeighsNormalsOfTrianglesByArea) {
  IndexedMesh corner = testing::tetrahedron();
  for (Vec3d& p : corner.positions) p = {p.x, 2 * p.y, 3 * p.z};
  const auto normal = to_surface_mesh(corner).normal(OpenMesh::VertexHandle(0));
  const std::array<double, 3> expected{-6.0 / 7, -3.0 / 7, -2.0 / 7};
  for (unsigned axis = 0; axis < 3; ++axis) EXPECT_NEAR(normal[axis], expected[axis], kRounding);
}

// The last of a vertex's half-edges stands in the middle of its fan, which is open at both ends.
TEST(SurfaceMesh, TakesAnOpenFanInAnyOrder) {
  const IndexedMesh source = testing::make_mesh(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 0, 0}}, {{0, 1, 2}, {0, 3, 4}, {0, 2, 3}});
  const SurfaceMesh mesh = to_surface_mesh(source);
  EXPECT_EQ(mesh.n_edges(), 7u);
  EXPECT_TRUE(mesh.is_boundary(OpenMesh::VertexHandle(0)));
  expect_openmesh_invariants(mesh);
}

TEST(SurfaceMesh, KeepsIsolatedVertices) {
  IndexedMesh source = testing::tetrahedron();
  source.positions.push_back({9, 9, 9});
  const SurfaceMesh mesh = to_surface_mesh(source);
  EXPECT_EQ(mesh.n_vertices(), 5u);
  EXPECT_TRUE(mesh.is_isolated(OpenMesh::VertexHandle(4)));
  expect_openmesh_invariants(mesh);
}

TEST(SurfaceMesh, SurvivesOpenMeshEditing) {
  SurfaceMesh mesh = to_surface_mesh(testing::icosphere(2));
  for (int round = 0; round < 50; ++round) {
    for (const auto h : mesh.halfedges())
      if (mesh.is_collapse_ok(h)) {
        mesh.collapse(h);
        break;
      }
    mesh.garbage_collection();
  }
  EXPECT_EQ(mesh.n_vertices(), 162u - 50u);
  expect_openmesh_invariants(mesh);
}

TEST(SurfaceMesh, RefusesWhatIsNotManifoldOrOriented) {
  for (const KnownMesh& known : testing::known_meshes())
    if (!known.manifold || !known.oriented) {
      EXPECT_NE(refusal(known.mesh), "accepted") << known.name;
    }
}

TEST(SurfaceMesh, NamesWhatIsNotManifold) {
  EXPECT_THAT(refusal(testing::tetrahedra_sharing_edge()), HasSubstr("vertices 0 and 1"));
  EXPECT_THAT(refusal(testing::tetrahedra_sharing_vertex()), HasSubstr("vertex 0"));
  EXPECT_THAT(refusal(testing::mobius_strip(5)), HasSubstr("same direction"));
  IndexedMesh bow_tie = testing::make_mesh(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}});
  EXPECT_THAT(refusal(bow_tie), HasSubstr("vertex 0"));
  IndexedMesh flag = testing::tetrahedron();  // a closed fan and an open one
  flag.positions.insert(flag.positions.end(), {{9, 0, 0}, {9, 1, 0}});
  flag.triangles.push_back({0, 4, 5});
  EXPECT_THAT(refusal(flag), HasSubstr("vertex 0"));
  IndexedMesh repeated = testing::tetrahedron();
  repeated.triangles[2] = {1, 1, 2};
  EXPECT_THAT(refusal(repeated), HasSubstr("triangle 2"));
  IndexedMesh beyond = testing::tetrahedron();
  beyond.triangles[3][1] = 4;
  EXPECT_THAT(refusal(beyond), HasSubstr("vertex 4"));
}

TEST(SurfaceMesh, RefusesInconsistentOpposites) {
  IndexedMesh mesh = testing::cube();
  mesh.opposite = opposite_half_edges(mesh.triangles, mesh.vertex_count());
  std::swap(mesh.opposite[4], mesh.opposite[9]);
  EXPECT_THAT(refusal(mesh), HasSubstr("half-edge"));
  mesh.opposite[4] = 1000;
  EXPECT_THAT(refusal(mesh), HasSubstr("half-edge"));
  mesh.opposite = opposite_half_edges(mesh.triangles, mesh.vertex_count());
  mesh.opposite[0] = 1;  // which starts where it should
  EXPECT_THAT(refusal(mesh), HasSubstr("triangle 0"));
  mesh.opposite.pop_back();
  EXPECT_THAT(refusal(mesh), HasSubstr("opposite half-edges"));
}

TEST(SurfaceMesh, RefusesMissingLabels) {
  IndexedMesh mesh = testing::cube();
  mesh.vertex_spheres.assign(3, on_sphere(0));
  EXPECT_THAT(refusal(mesh), HasSubstr("labels"));
}

TEST(SurfaceMesh, ColorsByElement) {
  IndexedMesh source = testing::tetrahedron();
  for (const SphereId s : {0u, 1u, 1u, 2u}) source.vertex_spheres.push_back(on_sphere(s));
  SurfaceMesh mesh = to_surface_mesh(source);
  const std::vector<std::string> elements{"O", "N", "Zn"};
  color_by_element(mesh, elements);
  const auto color = [&](int v) { return mesh.color(OpenMesh::VertexHandle(v)); };
  EXPECT_GT(color(0)[0], color(0)[2]) << "oxygen is red";
  EXPECT_GT(color(1)[2], color(1)[0]) << "nitrogen is blue";
  EXPECT_EQ(color(1), color(2));
  EXPECT_NE(color(3), color(0));
  // The last vertex is the first whose sphere has no element.
  try {
    color_by_element(mesh, std::span(elements).first(2));
    FAIL() << "not refused";
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "vertex 3 lies on sphere 2, but there are 2 elements");
  }
}

// Jmol's table gives these three; the symbol may be written in any case.
TEST(ElementColor, IsThatOfTheTable) {
  using Bytes = std::array<std::uint8_t, 3>;
  EXPECT_EQ(element_color("O"), (Bytes{255, 13, 13}));
  EXPECT_EQ(element_color("Fe"), (Bytes{224, 102, 51}));
  EXPECT_EQ(element_color("FE"), element_color("fe"));
  EXPECT_EQ(element_color("Uue"), element_color(""));
}

}  // namespace
}  // namespace vdwmesh
