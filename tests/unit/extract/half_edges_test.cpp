// The opposite half-edges that extraction hands over.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "extract/extractor.hpp"

namespace vdwmesh {
namespace {

SphereSet crowd(unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-6, 6), radius(0.4, 2.0);
  std::vector<Sphere> spheres(80);
  for (Sphere& s : spheres) s = {{place(random), place(random), place(random)}, radius(random)};
  return SphereSet(spheres);
}

void expect_paired(const IndexedMesh& mesh) {
  ASSERT_EQ(mesh.opposite.size(), 3 * mesh.triangle_count());
  const auto start = [&](std::size_t h) { return mesh.triangles[h / 3][h % 3]; };
  const auto end = [&](std::size_t h) { return mesh.triangles[h / 3][(h % 3 + 1) % 3]; };
  for (std::size_t h = 0; h < mesh.opposite.size(); ++h) {
    const std::size_t back = mesh.opposite[h];
    ASSERT_LT(back, mesh.opposite.size());
    ASSERT_EQ(mesh.opposite[back], h);
    ASSERT_EQ(start(back), end(h));
    ASSERT_EQ(end(back), start(h));
  }
}

TEST(HalfEdges, AreTheRightPairsForEveryField) {
  for (const FieldKind kind :
       {FieldKind::vdw, FieldKind::blinn, FieldKind::soft_object, FieldKind::inverse_squared}) {
    ExtractOptions options;
    options.field.kind = kind;
    options.grid.spacing = 0.35;
    options.connectivity = Connectivity::half_edges;
    expect_paired(make_cpu_extractor()->extract(crowd(1), options).mesh);
  }
}

TEST(HalfEdges, AreTheRightPairsWhereTheGridCutsTheSurface) {
  ExtractOptions options;
  options.grid.spacing = 0.5;
  options.grid.padding = 0;
  options.grid.box = GridBox::centers;
  options.connectivity = Connectivity::half_edges;
  const ExtractResult result = make_cpu_extractor()->extract(crowd(2), options);
  EXPECT_GT(result.stats.grid_clipped, 0u);
  expect_paired(result.mesh);
}

TEST(HalfEdges, AreLeftOutUnlessAskedFor) {
  EXPECT_TRUE(make_cpu_extractor()->extract(crowd(3), {}).mesh.opposite.empty());
}

}  // namespace
}  // namespace vdwmesh
