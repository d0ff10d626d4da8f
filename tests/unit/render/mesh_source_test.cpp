#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/errors.hpp"
#include "render/crease_split.hpp"
#include "render/picture.hpp"
#include "render/surface_source.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

using namespace testing;

constexpr Rgb kGrey{0.5f, 0.5f, 0.5f};

std::string refusal(const IndexedMesh& mesh, Paint paint = kGrey) {
  try {
    const MeshSource source(mesh, std::move(paint));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

void expect_says(const std::string& message, const std::string& words) {
  EXPECT_NE(message.find(words), std::string::npos) << message;
}

TEST(MeshSource, BrokenMeshesAreRefusedByName) {
  expect_says(refusal(empty_mesh()), "no triangles");
  IndexedMesh mesh = tetrahedron();
  mesh.triangles[2][1] = 77;
  expect_says(refusal(mesh), "triangle 2 names vertex 77");
  mesh = tetrahedron();
  mesh.positions[1].y = std::numeric_limits<double>::infinity();
  expect_says(refusal(mesh), "vertex 1");
  mesh = tetrahedron();
  for (Vec3d& p : mesh.positions) p = {p.x, 0, 0};
  expect_says(refusal(mesh), "no area");
}

TEST(MeshSource, PaintOfAnotherSizeIsRefused) {
  const ColorScale scale;
  const IndexedMesh mesh = tetrahedron();
  expect_says(refusal(mesh, VertexColors{{kGrey, kGrey}}), "2 colours");
  expect_says(refusal(mesh, VertexValues{{1, 2, 3}, scale}), "3 values");
  expect_says(refusal(mesh, TriangleValues{{}, scale}), "0 values");
  expect_says(refusal(mesh, TriangleValues{{1, 2, 3, 4}, {ColorMap::viridis, 1, 0, ""}}), "scale");
}

TEST(MeshSource, SupportIsThatOfTheTrianglesVertices) {
  IndexedMesh mesh = scaled(cube(), 2);
  mesh.positions.push_back({50, 50, 50});  // on no triangle
  const Vec3d directions[] = {{1, 0, 0}, {0, -1, 0}, {1, 1, 1}};
  EXPECT_EQ(MeshSource(mesh, kGrey).support(directions), (std::vector<double>{2, 0, 6}));
}

TEST(MeshSource, FillsWithPositionsAboutTheOriginAndOpaqueColors) {
  IndexedMesh mesh = translated(tetrahedron(), {1e6, 0, 0});
  mesh.normals.assign(4, Vec3f{0, 0.6f, -0.8f});
  const std::vector<Rgb> colors{{0, 0.5f, 1}, {-1, 2, 0.2f}, kGrey, kGrey};
  const MeshSource source(mesh, VertexColors{colors});
  std::vector<SurfaceVertex> vertices(source.vertex_count());
  source.write_vertices(vertices, {1e6 - 0.25, 0.5, 0});
  EXPECT_EQ(vertices[1].position, (Vec3f{1.25f, -0.5f, 0}));
  EXPECT_EQ(vertices[1].normal, (Vec3f{0, 0.6f, -0.8f}));
  EXPECT_EQ(vertices[0].color, (Rgba8{0, 128, 255, 255}));  // 127.5 is rounded up
  EXPECT_EQ(vertices[1].color, (Rgba8{0, 255, 51, 255}));
  EXPECT_EQ(vertices[0].value, 0);
  std::vector<Triangle> triangles(source.triangle_count());
  source.write_triangles(triangles);
  EXPECT_EQ(triangles[2], mesh.triangles[2]);
}

TEST(MeshSource, FillsWithItsValues) {
  const IndexedMesh mesh = tetrahedron();
  const ColorScale scale;
  const MeshSource by_vertex(mesh, VertexValues{{1, 2, 3, 4}, scale});
  std::vector<SurfaceVertex> vertices(4);
  by_vertex.write_vertices(vertices, {0, 0, 0});
  EXPECT_EQ(vertices[2].value, 3);
  const MeshSource by_triangle(mesh, TriangleValues{{5, 6, 7, 8}, scale});
  std::vector<float> values(4);
  by_triangle.write_triangle_values(values);
  EXPECT_EQ(values[3], 8);
}

TEST(VertexNormals, OfASphereAreItsRadii) {
  const IndexedMesh sphere = icosphere(4);
  const Buffer<Vec3f> normals = vertex_normals(sphere);
  for (std::size_t v = 0; v < normals.size(); ++v) {
    // The triangles around a vertex differ from each other by about the square of their size, 0.07.
    EXPECT_GT(dot(cast<double>(normals[v]), sphere.positions[v]), 1 - 0.5 * 0.005 * 0.005);
  }
}

// At the corner of a cube three faces meet with a right angle each, however they are cut.
TEST(VertexNormals, OfACubeAreItsDiagonals) {
  const Buffer<Vec3f> normals = vertex_normals(cube());
  const IndexedMesh mesh = cube();
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const Vec3d diagonal = (1 / norm(mesh.positions[v] - Vec3d{0.5, 0.5, 0.5})) *
                           (mesh.positions[v] - Vec3d{0.5, 0.5, 0.5});
    EXPECT_NEAR(dot(cast<double>(normals[v]), diagonal), 1, 1e-6);  // of float
  }
}

// Two triangles with an edge in common, on unit spheres about (-1, 0, 0) and (1, 0, 0).
IndexedMesh two_patches() {
  IndexedMesh mesh =
      make_mesh({{0, 0, 0}, {0, 0, 1}, {-1, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {0, 3, 1}});
  mesh.triangle_spheres.push_back(0);
  mesh.triangle_spheres.push_back(1);
  return mesh;
}
const SphereSet kTwoSpheres({{{-1, 0, 0}, 1}, {{1, 0, 0}, 1}});

TEST(CreaseSplit, EveryCornerHasTheNormalOfItsTrianglesSphere) {
  const IndexedMesh mesh = two_patches(), split = split_at_creases(mesh, kTwoSpheres);
  EXPECT_EQ(split.vertex_count(), 6u);  // both vertices of the crease are there twice
  for (std::size_t t = 0; t < 2; ++t) {
    const SphereId sphere = mesh.triangle_spheres[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = split.triangles[t][k];
      EXPECT_EQ(split.positions[v], mesh.positions[mesh.triangles[t][k]]);
      EXPECT_EQ(split.vertex_spheres[v], on_sphere(sphere));
      const Vec3d radius = split.positions[v] - kTwoSpheres[sphere].center;
      EXPECT_NEAR(dot(cast<double>(split.normals[v]), radius), norm(radius), 1e-6);  // of float
    }
  }
}

// The patches of both spheres, seen from outside of the first and from inside of the second.
PatchedMesh two_surface_patches() {
  PatchedMesh patched{two_patches(), {}, {0, 1}, {}};
  patched.mesh.triangle_spheres.clear();
  for (std::uint32_t v = 0; v < 4; ++v) {
    patched.mesh.normals.push_back({0, 0, 1});
    patched.mesh.vertex_spheres.push_back(on_sphere(v % 2));
  }
  for (const Sphere& sphere : kTwoSpheres.spheres()) {
    SurfacePatch patch;
    patch.kind = patched.patches.empty() ? PatchKind::contact : PatchKind::concave;
    patch.center = sphere.center;
    patch.radius = sphere.radius;
    patched.patches.push_back(patch);
  }
  return patched;
}

TEST(CreaseSplit, EveryCornerHasTheNormalOfItsPatch) {
  const PatchedMesh patched = two_surface_patches();
  const IndexedMesh split = split_at_patches(patched);
  EXPECT_EQ(split.vertex_count(), 6u);
  for (std::size_t t = 0; t < 2; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = split.triangles[t][k], given = patched.mesh.triangles[t][k];
      EXPECT_EQ(split.positions[v], patched.mesh.positions[given]);
      EXPECT_EQ(split.vertex_spheres[v], on_sphere(given % 2));
      const Vec3d out = (t == 0 ? 1.0 : -1.0) * (split.positions[v] - kTwoSpheres[t].center);
      EXPECT_NEAR(dot(cast<double>(split.normals[v]), out), norm(out), 1e-6);  // of float
    }
  }
}

// On the axis of a saddle, where it has no normal, the mesh's own stands.
TEST(CreaseSplit, ACuspHasTheNormalOfTheMesh) {
  PatchedMesh patched = two_surface_patches();
  patched.patches[1].kind = PatchKind::saddle;
  patched.patches[1].center = {0, 0, 0};
  patched.patches[1].axis = {0, 0, 1};
  patched.patches[1].ring_radius = 0.9;
  const IndexedMesh split = split_at_patches(patched);
  const std::uint32_t cusp = split.triangles[1][2];  // vertex 1, (0, 0, 1)
  EXPECT_EQ(split.normals[cusp], (Vec3f{0, 0, 1}));
}

TEST(CreaseSplit, NeedsPatchesThatAreThere) {
  PatchedMesh patched = two_surface_patches();
  patched.triangle_patch[1] = 2;
  EXPECT_THROW(split_at_patches(patched), InvalidInput);
  patched.triangle_patch.clear();
  EXPECT_THROW(split_at_patches(patched), InvalidInput);
}

TEST(CreaseSplit, NeedsLabelsThatNameSpheres) {
  IndexedMesh mesh = two_patches();
  mesh.triangle_spheres[1] = 2;
  EXPECT_THROW(split_at_creases(mesh, kTwoSpheres), InvalidInput);
  mesh.triangle_spheres.clear();
  EXPECT_THROW(split_at_creases(mesh, kTwoSpheres), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh
