// Contract of refine_patches(), on meshes of the excluded surface: vertices stay on spheres, tori
// and circles, topology stays exact, and area and volume are of second order. Expected measures are
// those of excluded_measures(), which has judges of its own.
#include "refine/patch_refiner.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "core/errors.hpp"
#include "excluded/excluded_mesher.hpp"
#include "support/ball_families.hpp"
#include "support/excluded_survey.hpp"
#include "support/shared_files.hpp"
#include "support/worst.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

// Å, of coordinates up to some 100 Å: rounding.
constexpr double kOffPatch = 1e-12;
// Second order in the edge length: errors divide by 4 at each level, up to terms of higher order.
constexpr double kOrderTwo = 4, kOrderTwoSlack = 0.1;
// Relative, of what two levels tend to.
constexpr double kExtrapolated = 1e-5;

PatchedMesh mesh_at(const SphereSet& atoms, double probe, double edge_length) {
  ExcludedMeshOptions options;
  options.probe = probe;
  options.edge_length = edge_length;
  return std::move(static_cast<PatchedMesh&&>(mesh_excluded(atoms, options)));
}

PatchedMesh refined(const SphereSet& atoms, PatchedMesh mesh, int levels) {
  return refine_patches(atoms, std::move(mesh), {.subdivisions = levels}).mesh;
}

// Everything that holds for every mesh of the excluded surface, refined or not.
ExcludedSurvey expect_sound(const SphereSet& atoms, double probe, const PatchedMesh& mesh,
                            const ExcludedSurface& exact) {
  const ExcludedSurvey s = survey_excluded(atoms, probe, mesh);
  EXPECT_TRUE(s.sound()) << s.text();
  EXPECT_LE(s.off_patch, kOffPatch) << s.text();
  EXPECT_EQ(s.facts.euler_characteristic(), exact.topology->euler_characteristic);
  EXPECT_EQ(s.facts.positive_shells + s.facts.negative_shells, exact.topology->shells.size());
  EXPECT_EQ(s.facts.negative_shells, exact.topology->cavities);
  return s;
}

struct LevelsToTry {
  int sound = 2;   // levels that are surveyed and, up to here, searched for self-intersections
  int orders = 3;  // levels whose errors are compared
  double smallest = 1e-9;  // relative error below which nothing is compared: rounding of the sums
};

// The errors of each level, relative to the exact measures.
void expect_second_order(const SphereSet& atoms, double probe, double edge_length,
                         const LevelsToTry& levels = {}) {
  const ExcludedSurface exact = excluded_measures(atoms, {.probe = probe}).complete;
  PatchedMesh mesh = mesh_at(atoms, probe, edge_length);
  double area = 0, volume = 0;  // errors of the level before
  for (int level = 0; level <= levels.orders; ++level) {
    SCOPED_TRACE("level " + std::to_string(level));
    if (level > 0) mesh = refined(atoms, std::move(mesh), 1);
    if (level <= levels.sound) {
      expect_sound(atoms, probe, mesh, exact);
      EXPECT_EQ(self_intersections(mesh.mesh), 0u);
    }
    const MeshMeasures m = measures(mesh.mesh);
    const double area_error = m.area / exact.area - 1, volume_error = *m.volume / exact.volume - 1;
    if (level > 1 && std::abs(area_error) > levels.smallest) {
      EXPECT_NEAR(area / area_error, kOrderTwo, kOrderTwoSlack);
      EXPECT_LE(std::abs(area_error + (area_error - area) / 3), kExtrapolated);
    }
    if (level > 1 && std::abs(volume_error) > levels.smallest) {
      EXPECT_NEAR(volume / volume_error, kOrderTwo, kOrderTwoSlack);
      EXPECT_LE(std::abs(volume_error + (volume_error - volume) / 3), kExtrapolated);
    }
    area = area_error, volume = volume_error;
  }
}

SphereSet pair_at(double distance) {
  return SphereSet({{{0.3, -0.2, 0.1}, 1.7}, {{0.3 + distance, -0.2, 0.1}, 1.5}});
}
// Atoms at the corners of a nearly equilateral triangle.
SphereSet triple_at(double side) {
  return SphereSet({{{0, 0, 0}, 1.7}, {{side, 0, 0}, 1.5}, {{0.48 * side, 0.87 * side, 0.1}, 1.6}});
}

// One atom; a ring, thick and thin; a spindle, whose saddle ends in cusps; and atoms apart.
TEST(PatchRefiner, RingsAndSpindles) {
  expect_second_order(SphereSet({{{1, 2, 3}, 1.7}}), 1.4, 0.35);
  for (const double distance : {0.5, 2.0, 3.2, 4.2, 4.7, 5.2, 6.2}) {
    SCOPED_TRACE(distance);
    expect_second_order(pair_at(distance), 1.4, 0.35);
  }
}

// High probes, and low ones, whose patches meet in creases.
TEST(PatchRefiner, Creases) {
  for (const double side : {2.0, 3.0, 3.6, 3.9, 4.2, 4.6, 5.0, 5.3, 5.8}) {
    SCOPED_TRACE(side);
    expect_second_order(triple_at(side), 1.4, 0.35);
  }
}

// Four and more atoms touch a probe; creases end in points of three.
TEST(PatchRefiner, Rings) {
  std::vector<Sphere> ring, cube;
  for (int i = 0; i < 6; ++i) {
    const double turn = std::numbers::pi * i / 3;
    ring.push_back({{1.4 * std::cos(turn), 1.4 * std::sin(turn), 0}, 1.7});
  }
  for (int i = 0; i < 8; ++i) {
    cube.push_back({{3.0 * (i & 1), 1.5 * (i & 2), 0.75 * (i & 4)}, 1.6});
  }
  for (const double probe : {0.7, 1.4}) {
    SCOPED_TRACE(probe);
    expect_second_order(SphereSet(ring), probe, 0.3);
    expect_second_order(SphereSet(cube), probe, 0.3);
  }
}

// Sets unlike proteins: sound after two levels, without self-intersections.
TEST(PatchRefiner, RandomSets) {
  Dice dice(2511);
  for (int i = 0; i < 24; ++i) {
    SCOPED_TRACE(i);
    const SphereSet atoms(i % 3 == 0   ? sparse_gas(dice)
                          : i % 3 == 1 ? dense_heap(dice)
                                       : chain(dice));
    const double probe = dice.real(0.3, 2), edge_length = dice.real(0.3, 0.8);
    const ExcludedSurface exact = excluded_measures(atoms, {.probe = probe}).complete;
    PatchedMesh mesh = mesh_at(atoms, probe, edge_length);
    for (int level = 1; level <= 2; ++level) {
      SCOPED_TRACE("level " + std::to_string(level));
      mesh = refined(atoms, std::move(mesh), 1);
      expect_sound(atoms, probe, mesh, exact);
      EXPECT_EQ(self_intersections(mesh.mesh), 0u);
    }
  }
}

// Small probes make as much concave as convex surface, and the volume's error nearly cancels: it
// then takes more levels until terms of the fourth order are small beside it.
TEST(PatchRefiner, Molecules) {
  const struct {
    const char* name;
    std::vector<double> probes;
  } sets[] = {{"1L2Y", {0.7, 1.4, 3.0}}, {"1CRN", {1.4, 3.0}}};
  for (const auto& set : sets) {
    const std::string file = std::string("reference/") + set.name + ".xyzr";
    VDWMESH_NEEDS_SHARED(file);
    const SphereSet atoms = read_xyzr(shared_path(file));
    for (const double probe : set.probes) {
      SCOPED_TRACE(std::string(set.name) + ", " + std::to_string(probe));
      expect_second_order(atoms, probe, 0.35, {.sound = 1, .orders = 2});
    }
  }
}

// By Gauss and Bonnet the Gaussian curvature of a surface without creases and corners sums to 2 π
// χ. Here it is taken at the corners of triangles, which is of second order.
TEST(PatchRefiner, CurvatureSumsToTheEulerCharacteristic) {
  for (const double distance : {0.5, 2.0, 3.2}) {
    SCOPED_TRACE(distance);
    const SphereSet atoms = pair_at(distance);
    PatchedMesh mesh = mesh_at(atoms, 1.4, 0.35);
    double last = 0;
    for (int level = 0; level <= 3; ++level) {
      if (level > 0) mesh = refined(atoms, std::move(mesh), 1);
      double total = 0;
      for (std::size_t t = 0; t < mesh.mesh.triangle_count(); ++t) {
        const SurfacePatch& patch = mesh.patches[mesh.triangle_patch[t]];
        Vec3d p[3];
        double curvature = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          p[k] = mesh.mesh.positions[mesh.mesh.triangles[t][k]];
          curvature += patch_curvatures(patch, p[k]).gaussian() / 3;
        }
        total += curvature * norm(cross(p[1] - p[0], p[2] - p[0])) / 2;
      }
      const double error = total / (4 * std::numbers::pi) - 1;
      EXPECT_LE(std::abs(error), 0.05);
      if (level > 1) {
        EXPECT_NEAR(last / error, kOrderTwo, kOrderTwoSlack);
      }
      last = error;
    }
  }
}

// The circle of the probe's centres is larger than the probe by a hair, or smaller, so the saddle
// has a waist of that radius or ends in cusps. Few triangles span a waist that is much thinner than
// they are long. A child of one may face against the normal at one of its corners, but no triangle
// crosses another one, and the next level is sound.
TEST(PatchRefiner, ThinWaists) {
  for (const double waist : {1e-2, 1e-3, -1e-3}) {
    SCOPED_TRACE(waist);
    const double rho = 1.4 + waist, distance = 2 * std::sqrt(2.9 * 2.9 - rho * rho);
    const SphereSet pair({{{0, 0, 0}, 1.5}, {{distance, 0, 0}, 1.5}});
    const ExcludedSurface exact = excluded_measures(pair).complete;
    const PatchedMesh given = mesh_at(pair, 1.4, 0.35);
    const PatchRefineResult once = refine_patches(pair, PatchedMesh(given), {.subdivisions = 1});
    EXPECT_EQ(once.levels[1].turned, 0u);
    EXPECT_EQ(self_intersections(once.mesh.mesh), 0u);
    const PatchedMesh twice = refined(pair, given, 2);
    expect_sound(pair, 1.4, twice, exact);
    EXPECT_EQ(self_intersections(twice.mesh), 0u);
  }
}

TEST(PatchRefiner, GivenVerticesStayAndChildrenHaveTheirParentsPatch) {
  const SphereSet atoms = triple_at(3.9);
  const PatchedMesh given = mesh_at(atoms, 1.4, 0.5);
  const PatchedMesh once = refined(atoms, given, 1), twice = refined(atoms, given, 2);
  for (const PatchedMesh* mesh : {&once, &twice}) {
    for (std::size_t v = 0; v < given.mesh.vertex_count(); ++v) {
      ASSERT_EQ(mesh->mesh.positions[v], given.mesh.positions[v]);
      ASSERT_EQ(mesh->mesh.normals[v], given.mesh.normals[v]);
      ASSERT_EQ(mesh->mesh.vertex_spheres[v], given.mesh.vertex_spheres[v]);
    }
  }
  ASSERT_EQ(once.mesh.triangle_count(), 4 * given.mesh.triangle_count());
  ASSERT_EQ(twice.triangle_patch.size(), 16 * given.mesh.triangle_count());
  for (std::size_t t = 0; t < twice.triangle_patch.size(); ++t) {
    ASSERT_EQ(twice.triangle_patch[t], given.triangle_patch[t / 16]);
  }
  const PatchedMesh same = refined(atoms, given, 0);
  EXPECT_EQ(same.mesh.positions, given.mesh.positions);
  EXPECT_EQ(same.mesh.triangles, given.mesh.triangles);
  EXPECT_EQ(same.triangle_patch, given.triangle_patch);
}

TEST(PatchRefiner, LevelsAreCountedAndObserved) {
  const SphereSet atoms = triple_at(3.9);
  std::vector<std::size_t> observed;
  const auto observe = [&](int level, const IndexedMesh& mesh) {
    EXPECT_EQ(level, static_cast<int>(observed.size()));
    observed.push_back(mesh.vertex_count());
  };
  const PatchRefineResult result =
      refine_patches(atoms, mesh_at(atoms, 1.4, 0.5), {.subdivisions = 2, .on_level = observe});
  ASSERT_EQ(result.levels.size(), 3u);
  ASSERT_EQ(observed.size(), 3u);
  std::size_t before = 0;
  for (std::size_t l = 0; l < 3; ++l) {
    const ProjectionStats& stats = result.levels[l];
    EXPECT_EQ(stats.projected, observed[l] - before);
    EXPECT_EQ(stats.unconverged + stats.out_of_reach + stats.undone + stats.turned, 0u);
    EXPECT_LE(stats.residual_max, kOffPatch);
    before = observed[l];
  }
}

// A vertex that is moved off its patch is counted, and a triangle that is turned over too.
TEST(PatchRefiner, WhatIsWrongIsCounted) {
  const SphereSet atoms({{{1, 2, 3}, 1.7}});
  PatchedMesh mesh = mesh_at(atoms, 1.4, 0.5);
  const std::vector<ProjectionStats> sound = refine_patches(atoms, PatchedMesh(mesh), {}).levels;
  EXPECT_EQ(sound[0].unconverged, 0u);
  mesh.mesh.positions[0] = mesh.mesh.positions[0] + Vec3d{0.01, 0.01, 0.01};
  EXPECT_EQ(refine_patches(atoms, PatchedMesh(mesh), {}).levels[0].unconverged, 1u);
  for (Triangle& t : mesh.mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(refine_patches(atoms, PatchedMesh(mesh), {}).levels[0].turned,
            mesh.mesh.triangle_count());
}

TEST(PatchRefiner, SameBitsOnAnyThreads) {
  VDWMESH_NEEDS_SHARED("reference/1L2Y.xyzr");
  const SphereSet atoms = read_xyzr(shared_path("reference/1L2Y.xyzr"));
  const PatchedMesh given = mesh_at(atoms, 1.4, 0.5);
  const PatchedMesh many = refined(atoms, given, 2);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const PatchedMesh alone = refined(atoms, given, 2);
  EXPECT_EQ(hash(many.mesh), hash(alone.mesh));
  EXPECT_EQ(many.triangle_patch, alone.triangle_patch);
}

TEST(PatchRefiner, RefusesWrongInput) {
  const SphereSet atoms = triple_at(3.9);
  const PatchedMesh sound = mesh_at(atoms, 1.4, 0.7);
  const auto refine = [&](PatchedMesh mesh, int levels = 1, std::uint64_t limit = kNoMemoryLimit) {
    refine_patches(atoms, std::move(mesh), {.subdivisions = levels, .memory_limit = limit});
  };
  EXPECT_THROW(refine(sound, -1), InvalidInput);
  EXPECT_THROW(refine(sound, kMaxSubdivisions + 1), InvalidInput);
  EXPECT_THROW(refine(sound, 2, 1000), LimitExceeded);
  PatchedMesh mesh = sound;
  mesh.triangle_patch.pop_back();
  EXPECT_THROW(refine(mesh), InvalidInput);
  mesh = sound;
  mesh.triangle_patch[3] = static_cast<std::uint32_t>(mesh.patches.size());
  EXPECT_THROW(refine(mesh), InvalidInput);
  mesh = sound;
  mesh.patches[0].atoms[0] = 3;
  EXPECT_THROW(refine(mesh), InvalidInput);
  mesh = sound;
  mesh.mesh.triangles[0] = mesh.mesh.triangles[1];
  EXPECT_THROW(refine(mesh), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh::testing
