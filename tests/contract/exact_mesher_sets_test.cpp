// The first of the seeded sets of bench/exact_mesh_sets: general ones have the topology of the
// union, and no angle below its floor; nearly degenerate ones have the topology too, or differ by
// what the mesher announced, or are refused.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <regex>
#include <string>

#include "contract/exact_mesher_contract.hpp"
#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "support/sphere_recipes.hpp"

namespace vdwmesh::testing {
namespace {

class ExactMesherSets : public ExactMesherContract {};
VDWMESH_INSTANTIATE_BACKENDS(ExactMesherSets);

constexpr unsigned kSets = 160;  // ten of each recipe
constexpr int kMostRefused = 6;

TEST_P(ExactMesherSets, AreSoundAndOfTheAnnouncedTopology) {
  int refused = 0;
  for (unsigned seed = 0; seed < kSets; ++seed) {
    const SeededSet set = seeded_set(seed);
    const SphereRecipe& recipe = sphere_recipes()[set.recipe];
    SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::string(recipe.name));
    try {
      const ExactMesh made = mesh_at(set.spheres, set.edge_length);
      expect_union_mesh(set.spheres, made.mesh, exact_union(set.spheres),
                        demands_of_set(set, made.stats));
      if (recipe.position == Position::general) {
        const AngleCensus angles = angle_census(set.spheres, made.mesh);
        EXPECT_EQ(angles.unexplained, 0u) << angles.text();
      }
    } catch (const LimitExceeded&) {
      EXPECT_EQ(recipe.name, "pencils");
      ++refused;
    }
  }
  EXPECT_LE(refused, kMostRefused);
}

class CountStages : public Monitor {
 public:
  void begin_stage(std::string_view, std::uint64_t) override { ++stages; }
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return false; }
  int stages = 0;
};

// Coarser sizes of features are tried only where they change the boundary: four balls through one
// circle to a hair, with no arc that is short, are refused after the rounds of the first sizes.
TEST_P(ExactMesherSets, NothingIsTriedAgainInVain) {
  CountStages monitor;
  ExactMeshOptions options;
  options.monitor = &monitor;
  const SeededSet set = seeded_set(83);
  options.edge_length = set.edge_length;
  EXPECT_THROW(mesh_with(set.spheres, options), LimitExceeded);
  EXPECT_GT(monitor.stages, 12);  // the rounds for the shape of triangles
  EXPECT_LT(monitor.stages, 40);
}

// Stops when more stages have begun than allowed.
class StopAtStage : public CountStages {
 public:
  explicit StopAtStage(int allowed) : allowed_(allowed) {}
  bool cancelled() const override { return stages > allowed_; }

 private:
  int allowed_;
};

// Curves that all but coincide end the splitting by the number of pieces of one arc, however large
// the molecule beside them is: with a limit on all pieces alone, 512 balls would allow half a
// million more. A round may double the pieces of an arc, so two rounds more than alone do.
TEST_P(ExactMesherSets, ALargeMoleculeAllowsNoMorePiecesOfOneArc) {
  const SeededSet set = seeded_set(17'000'499);
  ExactMeshOptions options;
  options.edge_length = set.edge_length;
  CountStages alone;
  options.monitor = &alone;
  EXPECT_THROW(mesh_with(set.spheres, options), LimitExceeded);
  std::vector<Sphere> beside(set.spheres.spheres().begin(), set.spheres.spheres().end());
  const SphereSet molecule = cluster(512, 1);
  for (const Sphere& s : molecule.spheres()) {
    beside.push_back({s.center + Vec3d{1000, 0, 0}, s.radius});
  }
  StopAtStage monitor(alone.stages + 2);
  options.monitor = &monitor;
  EXPECT_THROW(mesh_with(SphereSet(beside), options), LimitExceeded);
}

// The bytes that `mesh_with` says it needs where it is allowed a thousand.
std::uint64_t asked_bytes(const SphereSet& spheres, ExactMeshOptions options) {
  options.memory_limit = 1000;
  try {
    mesh_with(spheres, options);
  } catch (const LimitExceeded& error) {
    std::smatch found;
    const std::string text = error.what();
    if (std::regex_search(text, found, std::regex("triangles and ([0-9]+) bytes"))) {
      return std::stoull(found[1]);
    }
  }
  ADD_FAILURE() << "no refusal that names bytes";
  return 0;
}

// This set's mesh differs from the union by two, so that finer sizes are tried beside it. Where
// there is no room for a second mesh nobody knows whether it would be better, so none is given:
// less memory never leads to another mesh.
TEST_P(ExactMesherSets, NoMeshIsGivenWhereFinerSizesDoNotFit) {
  const SeededSet set = seeded_set(57);
  ExactMeshOptions options;
  options.edge_length = set.edge_length;
  EXPECT_EQ(mesh_with(set.spheres, options).stats.euler_difference, 2);
  options.memory_limit = asked_bytes(set.spheres, options);
  EXPECT_THROW(mesh_with(set.spheres, options), LimitExceeded);
}

class StopAfter : public Monitor {
 public:
  explicit StopAfter(int questions) : left_(questions) {}
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override {
    ++asked_;
    return asked_ > left_;
  }
  int asked() const { return asked_; }

 private:
  int left_;
  mutable std::atomic<int> asked_{0};
};

// One ball with a boundary of thousands of points: between two balls there is too long to wait.
TEST(ExactMesherSetsOnTheCpu, ACallerIsAskedWithinABall) {
  std::vector<Sphere> balls = {{{0, 0, 0}, 20}};
  const SphereSet shell = hollow_shell(60, 20, 1.5);
  balls.insert(balls.end(), shell.spheres().begin(), shell.spheres().end());
  const SphereSet spheres(std::move(balls));
  StopAfter never(1 << 30);
  ExactMeshOptions options;
  options.edge_length = 0.1;
  options.monitor = &never;
  const ExactMesh made = mesh_with(spheres, options);
  // Once in 128 points or pieces, of both sides of every arc.
  EXPECT_GT(never.asked(), static_cast<int>(made.stats.pieces / 128 + 61));
  for (const int questions : {0, 5, never.asked() / 2, never.asked() - 10}) {
    StopAfter monitor(questions);
    options.monitor = &monitor;
    EXPECT_THROW(mesh_with(spheres, options), Cancelled) << questions;
  }
}

}  // namespace
}  // namespace vdwmesh::testing
