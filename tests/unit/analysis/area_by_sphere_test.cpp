// Area of a mesh by sphere, and measures extrapolated to edge length 0.
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/mesh_measures.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

constexpr double kRounding = 1e-14;  // Å²: a few operations on numbers about 1

TEST(AreaBySphere, IsThatOfTheTrianglesOfTheSphere) {
  IndexedMesh mesh = testing::tetrahedron();  // three faces of 1/2, one of sqrt(3)/2
  mesh.vertex_spheres.assign(4, on_sphere(0));
  mesh.triangle_spheres = {2, 0, 0, 1};
  const std::vector<double> areas = mesh_area_by_sphere(mesh, 4);
  ASSERT_EQ(areas.size(), 4u);
  EXPECT_NEAR(areas[0], 1, kRounding);
  EXPECT_NEAR(areas[1], std::sqrt(3.0) / 2, kRounding);
  EXPECT_NEAR(areas[2], 0.5, kRounding);
  EXPECT_EQ(areas[3], 0);
}

TEST(AreaBySphere, GoesInThirdsToTheAtomsOfTheVerticesOtherwise) {
  IndexedMesh mesh = testing::tetrahedron();
  mesh.vertex_spheres.assign(4, on_sphere(0));
  mesh.vertex_spheres.set(0, on_sphere(1));  // on the three faces of 1/2
  const std::vector<double> areas = mesh_area_by_sphere(mesh, 2);
  ASSERT_EQ(areas.size(), 2u);
  EXPECT_NEAR(areas[1], 0.5, kRounding);
  EXPECT_NEAR(areas[0], 1 + std::sqrt(3.0) / 2, kRounding);
}

TEST(AreaBySphere, IsEmptyWhereTheMeshDoesNotSay) {
  IndexedMesh mesh = testing::tetrahedron();
  EXPECT_TRUE(mesh_area_by_sphere(mesh, 1).empty());
  mesh.vertex_spheres.assign(4, on_sphere(1));
  EXPECT_TRUE(mesh_area_by_sphere(mesh, 1).empty());
  mesh.triangle_spheres.assign(4, 1);
  EXPECT_TRUE(mesh_area_by_sphere(mesh, 1).empty());
  EXPECT_EQ(mesh_area_by_sphere(mesh, 2).size(), 2u);
}

TEST(Extrapolation, TakesTheSecondOrderOut) {
  const double limit = 7, slope = -3;
  const auto at = [&](double h) { return limit + slope * h * h; };
  EXPECT_NEAR(extrapolate_second_order(at(0.5), at(0.25)), limit, kRounding);
  EXPECT_TRUE(std::isnan(extrapolate_second_order(std::nan(""), 1)));
}

}  // namespace
}  // namespace vdwmesh
