// Series of a study whose runs follow exact laws.
#include "analysis/study.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace vdwmesh {
namespace {

constexpr double kTolerance = 1e-9;  // of orders and of extrapolated values near 1

// Area 1 - h, volume 1 + h² / 10, rms distances h³ and h, triangles 1000 / h².
StudyRun run_at(double h, const StudyKey& key) {
  StudyRun run;
  run.setting = {key, h};
  run.measures.area = 1 - h;
  run.measures.volume = 1 + h * h / 10;
  run.topology.triangles = static_cast<std::uint64_t>(1000 / (h * h));
  run.comparison.area_relative_error = -h;
  run.comparison.volume_relative_error = h * h / 10;
  run.comparison.distances.emplace();
  run.comparison.distances->mesh_to_surface.rms = h * h * h;
  run.comparison.distances->surface_to_mesh.rms = h;
  run.comparison.distances->hausdorff_lower_bound = std::sqrt(h);
  return run;
}

TEST(StudySeries, RunsThatDifferInResolutionAlone) {
  const StudyKey plain{Mesher::marching_cubes, FieldKind::vdw, Projection::none, 0, "cpu"};
  StudyKey refined = plain;
  refined.projection = Projection::vdw;
  refined.subdivisions = 1;
  std::vector<StudyRun> runs;
  for (const double h : {1.0, 0.25, 0.5}) {
    runs.push_back(run_at(h, refined));
    runs.push_back(run_at(h, plain));
  }
  const std::vector<StudySeries> series = find_series(runs);
  ASSERT_EQ(series.size(), 2u);
  EXPECT_EQ(series[0].key, plain);
  EXPECT_EQ(series[1].key, refined);
  EXPECT_EQ(series[0].runs, (std::vector<std::size_t>{3, 5, 1}));
  for (const StudySeries& s : series) {
    EXPECT_NEAR(s.by_resolution.area_error.value().order, 1, kTolerance);
    EXPECT_NEAR(s.by_resolution.volume_error.value().order, 2, kTolerance);
    EXPECT_NEAR(s.by_resolution.mesh_to_surface_rms.value().order, 3, kTolerance);
    EXPECT_NEAR(s.by_resolution.surface_to_mesh_rms.value().order, 1, kTolerance);
    EXPECT_NEAR(s.by_resolution.hausdorff.value().order, 0.5, kTolerance);
    EXPECT_NEAR(s.by_triangles.area_error.value().order, -0.5, kTolerance);
    EXPECT_NEAR(s.by_triangles.volume_error.value().order, -1, kTolerance);
    EXPECT_NEAR(s.area.value().limit, 1, kTolerance);
    EXPECT_NEAR(s.volume.value().limit, 1, kTolerance);
    EXPECT_NEAR(s.volume.value().order, 2, kTolerance);
  }
}

TEST(StudySeries, WhatRunsDoNotHaveIsLeftEmpty) {
  std::vector<StudyRun> runs;
  for (const double h : {1.0, 0.5}) {
    runs.push_back(run_at(h, {}));
    runs.back().comparison.distances.reset();
    runs.back().comparison.volume_relative_error.reset();
  }
  const StudySeries series = find_series(runs).at(0);
  EXPECT_TRUE(series.by_resolution.area_error);
  EXPECT_FALSE(series.by_resolution.volume_error);
  EXPECT_FALSE(series.by_resolution.hausdorff);
  EXPECT_FALSE(series.area);  // two runs have no extrapolation
  EXPECT_TRUE(find_series({}).empty());
}

}  // namespace
}  // namespace vdwmesh
