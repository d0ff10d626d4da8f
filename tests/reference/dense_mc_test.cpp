// Dense marching cubes and the mesh checks, on shapes known in closed form.
#include "reference/dense_mc.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "reference/closed_forms.hpp"
#include "reference/field_oracle.hpp"
#include "reference/mesh_checks.hpp"

namespace vdwmesh::reference {
namespace {

DenseMesh mesh_of(const std::vector<Ball>& balls, double half_width, double spacing) {
  DenseGrid grid;
  grid.spacing = spacing;
  const auto n = static_cast<std::int64_t>(std::ceil(2 * half_width / spacing));
  grid.cells = {n, n, n};
  grid.origin = {-half_width - 0.01, -half_width - 0.013, -half_width - 0.017};
  const auto inside = [&](const Point& p) { return sample_union(balls, p).signed_distance <= 0; };
  const auto at = [&](const Point& a, const Point& b) {
    const Point u = (1 / distance(a, b)) * (b - a);
    return a + bisect(inside, a, u, distance(a, b)).value_or(0) * u;
  };
  return dense_marching_cubes(
      grid, [&](const Node& n3) { return inside(grid.position(n3)); }, at);
}

TEST(DenseMarchingCubes, BallConvergesWithOrderTwo) {
  const Measures exact = ball(2);
  double last_area = 0, last_volume = 0;
  for (const double h : {0.4, 0.2, 0.1}) {
    const MeshFacts f = inspect(mesh_of({{{0, 0, 0}, 2}}, 2.5, h).mesh);
    EXPECT_TRUE(f.closed_oriented_manifold()) << f.summary();
    EXPECT_EQ(f.euler_characteristic(), 2);
    EXPECT_NEAR(f.angle_defect, 4 * std::numbers::pi, 1e-9);
    const double area = exact.area - f.area, volume = exact.volume - f.volume;
    if (last_area > 0) {
      // Order 2 quarters the error per halving; grid noise leaves some room.
      EXPECT_NEAR(last_area / area, 4, 0.8);
      EXPECT_NEAR(last_volume / volume, 4, 0.8);
    }
    last_area = area;
    last_volume = volume;
  }
}

TEST(DenseMarchingCubes, RingHasOneHandle) {
  std::vector<Ball> balls;
  for (int i = 0; i < 12; ++i) {
    const double a = i * std::numbers::pi / 6;
    balls.push_back({{4 * std::cos(a), 4 * std::sin(a), 0}, 1.6});
  }
  const MeshFacts f = inspect(mesh_of(balls, 6, 0.3).mesh);
  EXPECT_TRUE(f.closed_oriented_manifold()) << f.summary();
  EXPECT_EQ(f.euler_characteristic(), 0);
  EXPECT_EQ(f.genus(), 1);
  EXPECT_NEAR(f.volume / ring_of_balls(12, 4, 1.6).volume, 1, 0.02);
}

TEST(MeshChecks, SeeWhatIsWrong) {
  const TriangleMesh tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                 {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  EXPECT_TRUE(inspect(tetrahedron).closed_oriented_manifold());
  EXPECT_NEAR(inspect(tetrahedron).volume, 1. / 6, 1e-15);
  TriangleMesh open = tetrahedron;
  open.triangles.pop_back();
  EXPECT_EQ(inspect(open).open_edges, 3u);
  TriangleMesh flipped = tetrahedron;
  std::swap(flipped.triangles[0][0], flipped.triangles[0][1]);
  EXPECT_EQ(inspect(flipped).badly_oriented_edges, 3u);
  TriangleMesh inside_out = tetrahedron;
  for (Corners& t : inside_out.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(inspect(inside_out).negative_shells, 1u);
  TriangleMesh pinched = tetrahedron;  // two tetrahedra that share vertex 0
  for (const Point p : {Point{-1, 0, 0}, Point{0, -1, 0}, Point{0, 0, -1}}) {
    pinched.points.push_back(p);
  }
  for (const Corners t : {Corners{0, 4, 5}, Corners{0, 6, 4}, Corners{4, 6, 5}, Corners{0, 5, 6}}) {
    pinched.triangles.push_back(t);
  }
  EXPECT_EQ(inspect(pinched).split_vertices, 1u);
  EXPECT_EQ(inspect(pinched).open_edges, 0u);
  TriangleMesh doubled = tetrahedron;  // the same triangles twice
  doubled.triangles.insert(doubled.triangles.end(), tetrahedron.triangles.begin(),
                           tetrahedron.triangles.end());
  EXPECT_EQ(inspect(doubled).crowded_edges, 6u);
  TriangleMesh sick = tetrahedron;
  sick.points[1][2] = std::nan("");
  EXPECT_FALSE(inspect(sick).closed_oriented_manifold());
}

}  // namespace
}  // namespace vdwmesh::reference
