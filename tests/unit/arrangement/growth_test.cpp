// How the work of each stage grows with the set. Every loop over many things asks the monitor once
// in so many steps, so a monitor that counts the questions counts the steps. Sets of n, 2n and 4n
// balls are measured and meshed, and no stage may take much more than n log n steps.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "creases/exact_mesher.hpp"
#include "measures/exact_union.hpp"
#include "support/ball_families.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

// Counts the questions in each stage.
class StepCounter : public Monitor {
 public:
  void begin_stage(std::string_view name, std::uint64_t) override {
    const std::lock_guard lock(mutex_);
    current_ = &steps_[std::string(name)];
    ++rounds_[std::string(name)];
  }
  void advance(std::uint64_t) override {}
  bool cancelled() const override {
    ++*current_.load();
    return false;
  }
  // By stage. One that begins repeatedly, as rounds of meshing do until no piece is split, counts
  // by round: how many rounds there are is up to the narrowest place of all.
  std::map<std::string, std::uint64_t> steps() const {
    std::map<std::string, std::uint64_t> out;
    for (const auto& [stage, steps] : steps_) {
      const auto rounds = rounds_.find(stage);
      out[stage] = steps / (rounds == rounds_.end() ? 1 : rounds->second);
    }
    return out;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::atomic<std::uint64_t>> steps_;
  std::map<std::string, std::uint64_t> rounds_;
  std::atomic<std::atomic<std::uint64_t>*> current_ = &steps_["before the first stage"];
};

using MakeSet = std::function<std::vector<Sphere>(int)>;

// Four times as many balls are four times as much work, and a logarithm's share more; a step that
// grows with the power 3/2 takes eight times as much, one that looks at all pairs sixteen times.
// Stages that hardly ask are not judged.
constexpr double kMostGrowth = 7;
constexpr std::uint64_t kFewQuestions = 10;

void expect_growth(const MakeSet& balls, int count,
                   const std::function<void(const SphereSet&, Monitor&)>& run) {
  // The number of blocks follows that of cores.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  StepCounter few, many;
  run(SphereSet(balls(count)), few);
  run(SphereSet(balls(4 * count)), many);
  const auto before = few.steps();
  for (const auto& [stage, steps] : many.steps()) {
    const auto at = before.find(stage);
    const std::uint64_t least = std::max(kFewQuestions, at == before.end() ? 0 : at->second);
    EXPECT_LE(static_cast<double>(steps), kMostGrowth * static_cast<double>(least))
        << stage << ": " << least << " questions, then " << steps << ", of " << count << " and "
        << 4 * count << " balls";
  }
}

void mesh(const SphereSet& spheres, Monitor& monitor) {
  ExactMeshOptions options;
  options.edge_length = 1;
  options.monitor = &monitor;
  EXPECT_GT(mesh_union(spheres, options).mesh.triangles.size(), 0u);
}

template <UnionMethod kMethod>
void measure(const SphereSet& spheres, Monitor& monitor) {
  UnionOptions options;
  options.method = kMethod;
  options.monitor = &monitor;
  EXPECT_GT(exact_union(spheres, options).area, 0);
}

void expect_growth_of_all(const MakeSet& balls, int count) {
  {
    SCOPED_TRACE("mesh");
    expect_growth(balls, count, mesh);
  }
  {
    SCOPED_TRACE("triangulation");
    expect_growth(balls, count, measure<UnionMethod::cgal>);
  }
  {
    SCOPED_TRACE("arcs");
    expect_growth(balls, count, measure<UnionMethod::arcs>);
  }
}

// Small balls on the sphere of a large one, as dense for every number.
std::vector<Sphere> around_a_large_ball(int count) {
  Dice dice(30);
  const double radius = 1.2 * std::sqrt(count);
  std::vector<Sphere> balls{{{0, 0, 0}, radius}};
  for (int i = 0; i < count; ++i) {
    balls.push_back({radius * random_direction(dice), dice.real(1, 1.5)});
  }
  return balls;
}

TEST(Growth, SmallBallsOnALargeOne) { expect_growth_of_all(around_a_large_ball, 1000); }

// Small balls that stand apart on a large one, so that its patch has whole circles alone.
TEST(Growth, CirclesOnALargeBall) {
  const auto balls = [](int count) {
    const double radius = 3 * std::sqrt(count);
    std::vector<Sphere> out{{{0, 0, 0}, radius}};
    for (int i = 0; i < count; ++i) {
      constexpr double kGoldenAngle = 2.399963229728653;
      const double z = 1 - (2 * i + 1.0) / count, wide = std::sqrt(1 - z * z);
      out.push_back(
          {radius * Vec3d{wide * std::cos(kGoldenAngle * i), wide * std::sin(kGoldenAngle * i), z},
           1});
    }
    return out;
  };
  expect_growth_of_all(balls, 1000);
}

// Ever more copies of the same atoms, each moved a little.
TEST(Growth, JitteredCopies) {
  const auto balls = [](int count) {
    Dice dice(32);
    constexpr int kAtoms = 20;
    std::vector<Sphere> atoms, out;
    for (int i = 0; i < kAtoms; ++i) {
      atoms.push_back({{dice.real(0, 5), dice.real(0, 5), dice.real(0, 5)}, dice.real(1.5, 1.9)});
    }
    for (int i = 0; i < count; ++i) {
      const Sphere& s = atoms[static_cast<std::size_t>(i % kAtoms)];
      out.push_back({s.center + dice.real(0, 0.3) * random_direction(dice), s.radius});
    }
    return out;
  };
  // Measures by arcs cut every ball by all that overlap it.
  expect_growth(balls, 8000, mesh);
  expect_growth(balls, 8000, measure<UnionMethod::cgal>);
}

// Balls that touch their neighbours on two skew lines: the triangulation of n balls has about n²/4
// cells, so n²/4 is what all may grow with.
TEST(Growth, BallsOnSkewLines) {
  const auto balls = [](int count) {
    std::vector<Sphere> out;
    const int half = static_cast<int>(std::sqrt(count));
    for (int i = 0; i < half; ++i) {
      out.push_back({{2.0 * i - half, 0, 0}, 1});
      out.push_back({{0.37, 2.0 * i - half + 0.21, 2.5}, 1});
    }
    return out;
  };
  SCOPED_TRACE("triangulation");
  expect_growth(balls, 20000, measure<UnionMethod::cgal>);
}

// The memory for so many cells is refused before it is taken.
TEST(Growth, CellsOfSkewLinesKeepTheMemoryLimit) {
  std::vector<Sphere> balls;
  for (int i = 0; i < 1000; ++i) {
    balls.push_back({{2.0 * i - 1000, 0, 0}, 1});
    balls.push_back({{0.37, 2.0 * i - 1000 + 0.21, 2.5}, 1});
  }
  UnionOptions options;
  options.method = UnionMethod::cgal;
  options.memory_limit = 20'000'000;
  EXPECT_THROW(exact_union(SphereSet(std::move(balls)), options), LimitExceeded);
}

// Shells of balls with a void in each.
TEST(Growth, ManyVoids) {
  const auto balls = [](int count) {
    std::vector<Sphere> out;
    const int side = static_cast<int>(std::lround(std::cbrt(count)));
    for (int i = 0; i < side * side * side; ++i) {
      const Vec3d at{6.0 * (i % side), 6.0 * (i / side % side), 6.0 * (i / side / side)};
      for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
          Vec3d center = at;
          center[axis] += 1.6 * sign;
          out.push_back({center, 1.58 + 1e-3 * axis});
        }
      }
      for (int corner = 0; corner < 8; ++corner) {
        const auto of = [&](int bit) { return (corner >> bit) % 2 == 0 ? -1.3 : 1.3; };
        out.push_back({at + Vec3d{of(0), of(1), of(2)}, 1.4});
      }
    }
    return out;
  };
  expect_growth_of_all(balls, 125);
}

// Chains of balls, of which each one overlaps the next.
TEST(Growth, ManyChains) {
  const auto balls = [](int count) {
    Dice dice(7);
    std::vector<Sphere> out;
    constexpr int kLength = 20;
    const int side = static_cast<int>(std::ceil(std::sqrt(count)));
    for (int chain = 0; chain < count; ++chain) {
      for (int i = 0; i < kLength; ++i) {
        out.push_back({{5.0 * (chain % side) + dice.real(0, 0.2),
                        5.0 * (chain / side) + dice.real(0, 0.2), 1.5 * i},
                       1 + dice.real(0, 0.2)});
      }
    }
    return out;
  };
  expect_growth_of_all(balls, 100);
}

}  // namespace
}  // namespace vdwmesh::testing
