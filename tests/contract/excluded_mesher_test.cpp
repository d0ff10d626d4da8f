// Contract of mesh_excluded(): closed oriented manifolds of the exact topology whose vertices lie
// on the patches, without self-intersections, and with area and volume of second order.
#include "excluded/excluded_mesher.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "contract/excluded_measures_contract.hpp"
#include "core/errors.hpp"
#include "reference/cages.hpp"
#include "support/ball_families.hpp"
#include "support/excluded_survey.hpp"
#include "support/shared_files.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

// Å, of coordinates up to some 100 Å: rounding.
constexpr double kOffPatch = 1e-12;
// Share by which sums over triangles may exceed those over patches, whose chords are shorter.
constexpr double kAreaOfMesh = 0.1;

ExcludedMesh mesh_at(const SphereSet& atoms, double probe, double edge_length,
                     bool exterior = false) {
  ExcludedMeshOptions options;
  options.probe = probe;
  options.edge_length = edge_length;
  options.exterior = exterior;
  return mesh_excluded(atoms, options);
}

// Everything that holds for every mesh. Returns the mesh.
ExcludedMesh expect_mesh(const SphereSet& atoms, double probe, double edge_length,
                         bool exterior = false, double off_patch = kOffPatch) {
  const ExcludedMeasures measures =
      excluded_measures(atoms, {.probe = probe, .exterior = exterior});
  const ExcludedSurface& exact = exterior ? *measures.exterior : measures.complete;
  ExcludedMesh mesh = mesh_at(atoms, probe, edge_length, exterior);
  const ExcludedSurvey s = survey_excluded(atoms, probe, mesh);
  EXPECT_TRUE(s.sound()) << s.text();
  EXPECT_LE(s.off_patch, off_patch) << s.text();
  EXPECT_EQ(s.facts.euler_characteristic(), exact.topology->euler_characteristic);
  EXPECT_EQ(s.facts.positive_shells + s.facts.negative_shells, exact.topology->shells.size());
  EXPECT_EQ(s.facts.negative_shells, exact.topology->cavities);
  EXPECT_EQ(self_intersections(mesh.mesh), 0u) << s.text();
  EXPECT_NEAR(s.facts.area, exact.area, kAreaOfMesh * exact.area);
  const ByPatchKind& kinds = exact.area_by_kind;
  EXPECT_NEAR(s.area_by_kind[0], kinds.contact, kAreaOfMesh * exact.area);
  EXPECT_NEAR(s.area_by_kind[1], kinds.saddle, kAreaOfMesh * exact.area);
  EXPECT_NEAR(s.area_by_kind[2], kinds.concave, kAreaOfMesh * exact.area);
  return mesh;
}

SphereSet pair_at(double distance) {
  return SphereSet({{{0.3, -0.2, 0.1}, 1.7}, {{0.3 + distance, -0.2, 0.1}, 1.5}});
}
// Atoms at the corners of a nearly equilateral triangle.
SphereSet triple_at(double side) {
  return SphereSet({{{0, 0, 0}, 1.7}, {{side, 0, 0}, 1.5}, {{0.48 * side, 0.87 * side, 0.1}, 1.6}});
}

TEST(ExcludedMesher, OneBall) { expect_mesh(SphereSet({{{1, 2, 3}, 1.7}}), 1.4, 0.35); }

// Swallowed, whole rings thick and thin, spindles, and apart.
TEST(ExcludedMesher, TwoBalls) {
  for (const double distance : {0.1, 0.5, 2.0, 3.2, 4.2, 4.7, 5.2, 5.9, 6.2}) {
    for (const double edge_length : {0.7, 0.35, 0.2}) {
      SCOPED_TRACE(std::to_string(distance) + ", " + std::to_string(edge_length));
      expect_mesh(pair_at(distance), 1.4, edge_length);
    }
  }
}

// A ring whose waist is nearly nothing, and a spindle that nearly is a ring.
TEST(ExcludedMesher, ThinWaists) {
  // For two balls of 1.5 Å the circle of the probe's centres has the radius √(2.9² - (d/2)²).
  for (const double waist : {1e-1, 1e-2, 1e-3, -1e-3, -1e-2, -1e-1}) {
    SCOPED_TRACE(waist);
    const double rho = 1.4 + waist, distance = 2 * std::sqrt(2.9 * 2.9 - rho * rho);
    expect_mesh(SphereSet({{{0, 0, 0}, 1.5}, {{distance, 0, 0}, 1.5}}), 1.4, 0.35);
  }
}

// The probe's circle has just the probe's radius, or differs from it by less than any edge can
// show: a waist of no width, which gets a few flat triangles and no point on the axis.
TEST(ExcludedMesher, WaistsOfNoWidth) {
  constexpr std::uint64_t kMostTriangles = 50'000;
  struct Tie {
    double radius, distance, probe;
  };
  for (const auto& [radius, distance, probe] : {Tie{1, 4, 1.5}, Tie{2, 8, 3}}) {
    for (const double less : {0.0, 1e-15, 1e-12, 1e-10, 1e-8, 1e-6, 1e-5}) {
      for (const double edge_length : {0.7, 0.35, 0.1}) {
        SCOPED_TRACE(::testing::Message() << distance << " less " << less << ", " << edge_length);
        const double d = distance * (1 - less);
        const SphereSet pair({{{0, 0, 0}, radius}, {{d, 0, 0}, radius}});
        const ExcludedMesh mesh = expect_mesh(pair, probe, edge_length);
        const double ideal = measures(mesh.mesh).area / (0.43 * edge_length * edge_length);
        EXPECT_LT(static_cast<double>(mesh.mesh.triangle_count()), kMostTriangles + 2 * ideal);
      }
    }
  }
  std::vector<Sphere> lattice;
  for (int i = 0; i < 8; ++i) {
    lattice.push_back({{4.0 * (i & 1), 2.0 * (i & 2), 1.0 * (i & 4)}, 1});
  }
  expect_mesh(SphereSet(lattice), 1.5, 0.35);
}

// The probes are high; low, so that their patches meet in a crease; or there are none.
TEST(ExcludedMesher, ThreeBalls) {
  for (const double side : {2.0, 3.0, 3.6, 3.9, 4.2, 4.6, 5.0, 5.3, 5.8}) {
    for (const double edge_length : {0.7, 0.35}) {
      SCOPED_TRACE(std::to_string(side) + ", " + std::to_string(edge_length));
      expect_mesh(triple_at(side), 1.4, edge_length);
    }
  }
}

// The corners of an octahedron touch probes in its faces; the inside is a cavity or not.
TEST(ExcludedMesher, Cavities) {
  for (const double radius : {2.8, 3.6, 4.1}) {
    std::vector<Sphere> atoms;
    for (const Vec3d& d : {Vec3d{1, 0.01, 0},
                           {-1, 0.02, 0.01},
                           {0, 1, 0.03},
                           {0.02, -1, 0},
                           {0, 0.01, 1},
                           {0.03, 0, -1}}) {
      atoms.push_back({radius * d, 2.2});
    }
    SCOPED_TRACE(radius);
    expect_mesh(SphereSet(atoms), 0.8, 0.4);
    expect_mesh(SphereSet(atoms), 0.8, 0.4, true);
  }
}

// Many atoms touch one probe.
TEST(ExcludedMesher, CrowdedProbes) {
  std::vector<Sphere> ring, cube;
  for (const reference::Point& c : reference::regular_polygon(6, 1.4)) {
    ring.push_back({{c[0], c[1], c[2]}, 1.7});
  }
  for (int i = 0; i < 8; ++i) {
    cube.push_back({{3.0 * (i & 1), 1.5 * (i & 2), 0.75 * (i & 4)}, 1.6});
  }
  for (const double probe : {0.7, 1.4, 3.0}) {
    SCOPED_TRACE(probe);
    expect_mesh(SphereSet(ring), probe, 0.4);
    expect_mesh(SphereSet(cube), probe, 0.4);
  }
}

// Two probes 0.08 Å from each other on both sides of three atoms, so that each has only slivers of
// its patch left; the fourth atom keeps other probes away. One sliver is bounded by two sides and a
// crease that meet under 2° and less, and the first chord of a side passes beyond the crease. This
// turns the sliver around, and what is to be split are its own pieces, not those all around that
// have the wrong sides marked.
TEST(ExcludedMesher, AChordBeyondTheOtherSideOfASliver) {
  const SphereSet atoms({{{240.720, 111.367, 167.326}, 1.7},
                         {{241.464, 112.669, 167.395}, 1.7},
                         {{240.614, 113.749, 168.012}, 1.7},
                         {{245.084, 111.279, 162.942}, 1.7}});
  for (const double edge_length : {1.0, 0.7, 0.5, 0.35}) {
    SCOPED_TRACE(edge_length);
    expect_mesh(atoms, 1.4, edge_length);
  }
}

// Two atoms all but coincide, so that their probes lie in pairs as near to each other, and patches
// are slivers, whose first chords cross over each other. Where a probe touches two atoms that are
// 10⁻⁷ Å apart follows from their difference, of which rounding of coordinates below 4 Å, 2⁻⁵¹ of
// an Å, leaves 4e-9; and the probe is 3 Å away.
TEST(ExcludedMesher, Twins) {
  constexpr double kOffPatchOfTwins = 2e-8;
  Dice dice(2512);
  for (int i = 0; i < 20; ++i) {
    std::vector<Sphere> atoms(static_cast<std::size_t>(dice.whole(2, 5)));
    for (Sphere& s : atoms) s = {random_point(dice, 3), dice.real(1.2, 1.9)};
    atoms.push_back(atoms[0]);
    atoms.back().center =
        atoms[0].center + std::pow(10, dice.real(-7, -4)) * random_direction(dice);
    SCOPED_TRACE(i);
    expect_mesh(SphereSet(atoms), 1.4, 0.7, false, kOffPatchOfTwins);
  }
}

// Curves nearer than double precision tells them apart: two atoms at 2·10⁻¹³ Å. The limit of pieces
// of a curve ends the splitting, before that of memory does.
TEST(ExcludedMesher, CurvesTooCloseAreRefused) {
  const SphereSet atoms({{{-0.62398072410211602, 1.3578527558693247, -2.5823597666731049}, 1.25},
                         {{0.19796461228475604, -1.311940823126506, -2.0339964764260143}, 1.625},
                         {{-0.623980724102299, 1.3578527558693054, -2.582359766673229}, 1.25}});
  ExcludedMeshOptions options;
  options.edge_length = 0.7;
  options.memory_limit = 2'000'000'000;
  try {
    mesh_excluded(atoms, options);
    FAIL() << "there is a mesh";
  } catch (const LimitExceeded& error) {
    EXPECT_NE(std::string(error.what()).find("too close to be told apart"), std::string::npos)
        << error.what();
  }
}

// Rings of atoms whose hole is just the probe: the patches of its two mirror images have no width,
// along all sides at once. The limit of pieces of all curves ends the splitting.
TEST(ExcludedMesher, RingsThatHoldTheProbeAreRefused) {
  constexpr double kAround = 2.9;  // Å: 1.5 and 1.4
  for (const int count : {4, 5, 8}) {
    std::vector<Sphere> ring;
    for (int i = 0; i < count; ++i) {
      const double turn = 2 * std::numbers::pi * i / count + 0.3;
      ring.push_back({{kAround * std::cos(turn), kAround * std::sin(turn), 0}, 1.5});
    }
    try {
      mesh_at(SphereSet(ring), 1.4, 0.35);
      ADD_FAILURE() << "there is a mesh";
    } catch (const LimitExceeded& error) {
      EXPECT_NE(std::string(error.what()).find("points on all of them"), std::string::npos)
          << error.what();
    }
  }
}

// A mesh of a few MB, of patches that are a thousandth of their probe's sphere.
TEST(ExcludedMesher, SmallPatchesOfHugeProbes) {
  const SphereSet atoms({{{0, 0, 0}, 1.7}, {{3, 0, 0}, 1.5}, {{1.4, 2.6, 0}, 1.6}});
  EXPECT_LT(mesh_at(atoms, 1e6, 0.1).mesh.triangle_count(), 100'000u);
}

// Sets in general position; a set that has no mesh says so, and there may be few of them.
TEST(ExcludedMesher, RandomSets) {
  Dice dice(2611);
  int refused = 0;
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    const SphereSet atoms(i % 3 == 0   ? sparse_gas(dice)
                          : i % 3 == 1 ? dense_heap(dice)
                                       : chain(dice));
    try {
      expect_mesh(atoms, dice.real(0.3, 2), dice.real(0.3, 0.8));
    } catch (const LimitExceeded& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()).find("has no mesh"), std::string::npos) << error.what();
    }
  }
  EXPECT_LE(refused, 3);
}

// Errors of area and volume fall by four when the edges become half as long. Meshes of different
// edge lengths have different triangles, so not by exactly that.
TEST(ExcludedMesher, SecondOrder) {
  for (const SphereSet& atoms : {pair_at(3.2), pair_at(4.7), triple_at(3.9)}) {
    const ExcludedSurface exact = excluded_measures(atoms).complete;
    double area = 0, volume = 0;
    for (const double edge_length : {0.16, 0.08, 0.04}) {
      const MeshMeasures m = measures(mesh_at(atoms, 1.4, edge_length).mesh);
      const double area_error = exact.area - m.area, volume_error = exact.volume - *m.volume;
      if (area != 0) {
        EXPECT_NEAR(area / area_error, 4, 0.6);
        EXPECT_NEAR(volume / volume_error, 4, 0.6);
      }
      area = area_error;
      volume = volume_error;
    }
    EXPECT_LE(std::abs(area), 1e-3 * exact.area);
    EXPECT_LE(std::abs(volume), 1e-3 * exact.volume);
  }
}

TEST(ExcludedMesher, Molecules) {
  for (const char* name : {"1L2Y", "1CRN"}) {
    const std::string file = std::string("reference/") + name + ".xyzr";
    VDWMESH_NEEDS_SHARED(file);
    const SphereSet atoms = read_xyzr(shared_path(file));
    for (const double probe : {0.7, 1.4, 3.0}) {
      SCOPED_TRACE(std::string(name) + ", " + std::to_string(probe));
      const ExcludedMesh mesh = expect_mesh(atoms, probe, 0.5);
      EXPECT_GE(quality(mesh.mesh).min_angle_deg.p01, 15);
    }
  }
}

// Strips between pieces of very different lengths: with the widest view of the union's mesher, 1 %
// of the triangles had angles below 14.0° and 14.2° here.
TEST(ExcludedMesher, AnglesAtLongEdges) {
  for (const auto& [name, probe] : {std::pair{"1CKB", 1.4}, {"1HH0", 0.7}}) {
    const std::string file = std::string("reference/") + name + ".xyzr";
    VDWMESH_NEEDS_SHARED(file);
    SCOPED_TRACE(name);
    const ExcludedMesh mesh = mesh_at(read_xyzr(shared_path(file)), probe, 0.7);
    EXPECT_GE(quality(mesh.mesh).min_angle_deg.p01, 15);
  }
}

TEST(ExcludedMesher, SameBitsOnAnyThreads) {
  VDWMESH_NEEDS_SHARED("reference/1L2Y.xyzr");
  const SphereSet atoms = read_xyzr(shared_path("reference/1L2Y.xyzr"));
  const ExcludedMesh many = mesh_at(atoms, 1.4, 0.5);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const ExcludedMesh alone = mesh_at(atoms, 1.4, 0.5);
  EXPECT_EQ(hash(many.mesh), hash(alone.mesh));
  EXPECT_EQ(many.triangle_patch, alone.triangle_patch);
}

TEST(ExcludedMesher, RefusesWrongOptions) {
  const SphereSet atoms = pair_at(3);
  for (const double wrong : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(mesh_at(atoms, 1.4, wrong), InvalidInput);
    EXPECT_THROW(mesh_at(atoms, wrong, 0.4), InvalidInput);
  }
  EXPECT_THROW(mesh_at(SphereSet(), 1.4, 0.4), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh::testing
