#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "analysis/quality_histograms.hpp"
#include "core/errors.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

std::uint64_t total(const Histogram& h) {
  return std::accumulate(h.counts.begin(), h.counts.end(), h.below + h.above);
}

TEST(Histogram, PutsValuesOnEdgesIntoTheBinAbove) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Histogram h = histogram(std::vector{-0.1, 0.0, 0.9, 1.0, 2.0, 3.0, 4.0, 4.1, nan},
                                BinScale::linear, 0, 4, 4);
  EXPECT_EQ(h.counts, (std::vector<std::uint64_t>{2, 1, 1, 2}));
  EXPECT_EQ(h.below, 2u);  // -0.1 and NaN
  EXPECT_EQ(h.above, 1u);
}

TEST(Histogram, LogarithmicBinsAreOctaves) {
  // Values off the edges, where a logarithm's rounding cannot decide.
  const Histogram h =
      histogram(std::vector{1.5, 3.0, 3.5, 7.9, 0.9, 8.1}, BinScale::logarithmic, 1, 8, 3);
  EXPECT_EQ(h.counts, (std::vector<std::uint64_t>{1, 2, 1}));
  EXPECT_EQ(h.below, 1u);
  EXPECT_EQ(h.above, 1u);
}

TEST(Histogram, RefusesImpossibleBins) {
  EXPECT_THROW(histogram({}, BinScale::linear, 0, 1, 0), InvalidInput);
  EXPECT_THROW(histogram({}, BinScale::linear, 1, 1, 3), InvalidInput);
  EXPECT_THROW(histogram({}, BinScale::logarithmic, 0, 1, 3), InvalidInput);
}

TEST(QualityHistograms, OfAnIcosahedron) {
  // 20 equilateral triangles and 30 edges of 2 Å: the last bin of angles, the first of aspect
  // ratios, and the bin of edges that holds 2 = 2^-10 · 2^(44/4), or the one below by rounding.
  const QualityHistograms h = quality_histograms(testing::icosahedron());
  EXPECT_EQ(h.min_angle_deg.counts.back(), 20u);
  EXPECT_EQ(h.aspect_ratio.counts.front(), 20u);
  EXPECT_EQ(h.edge_length.counts.at(43) + h.edge_length.counts.at(44), 30u);
  for (const Histogram* one : {&h.min_angle_deg, &h.aspect_ratio}) EXPECT_EQ(total(*one), 20u);
  EXPECT_EQ(total(h.edge_length), 30u);
}

TEST(QualityHistograms, DegenerateTrianglesHaveNoAspectRatio) {
  const IndexedMesh mesh = testing::make_mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}},
                                              {{0, 1, 2}, {0, 1, 1}, {0, 1, 3}});
  const QualityHistograms h = quality_histograms(mesh);
  EXPECT_EQ(h.min_angle_deg.counts.front(), 2u);
  EXPECT_EQ(total(h.min_angle_deg), 3u);
  EXPECT_EQ(total(h.aspect_ratio), 1u);
}

}  // namespace
}  // namespace vdwmesh
