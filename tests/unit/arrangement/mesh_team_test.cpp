// Several processes that mesh a set together, each its part, beside one process: the same mesh and
// the same counts, bit by bit. The processes are threads here; test_ranks.py has those of MPI.
#include "creases/share/mesh_team.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <barrier>
#include <exception>
#include <numeric>
#include <string_view>
#include <thread>
#include <vector>

#include "core/errors.hpp"
#include "creases/share/patch_device.hpp"
#include "support/family_sets.hpp"
#include "support/floor_sets.hpp"

namespace vdwmesh::testing {
namespace {

using Words = std::vector<std::vector<std::uint64_t>>;

// What the members of a team have in common.
struct Meeting {
  explicit Meeting(std::size_t count)
      : barrier(static_cast<std::ptrdiff_t>(count)),
        numbers(count),
        words(count),
        splits(count),
        errors(count),
        pieces(count),
        stats(count) {}

  std::barrier<> barrier;
  std::vector<std::uint64_t> numbers;  // this and all that follow: by member
  std::vector<Words> words;
  std::vector<std::vector<PieceSplit>> splits;
  std::vector<std::exception_ptr> errors;
  std::vector<UnnumberedPiece> pieces;
  std::vector<ExactMeshStats> stats;
};

class Member final : public MeshTeam {
 public:
  Member(Meeting& meeting, std::size_t number) : meeting_(meeting), number_(number) {}

  std::size_t count() const override { return meeting_.numbers.size(); }
  std::size_t number() const override { return number_; }
  void together(const std::function<void()>& work) const override {
    std::exception_ptr mine;
    try {
      work();
    } catch (...) {
      mine = std::current_exception();
    }
    for (const std::exception_ptr& error : of_all(meeting_.errors, mine)) {
      if (error) std::rethrow_exception(error);
    }
  }
  void merge(std::vector<PieceSplit>& splits) const override {
    const auto all = of_all(meeting_.splits, splits);
    splits.clear();
    for (const auto& theirs : all) splits.insert(splits.end(), theirs.begin(), theirs.end());
    merge_splits(splits);
  }
  std::uint32_t least(std::uint32_t mine) const override {
    return static_cast<std::uint32_t>(
        std::ranges::min(of_all(meeting_.numbers, std::uint64_t{mine})));
  }
  std::uint64_t sum(std::uint64_t mine) const override {
    const auto all = of_all(meeting_.numbers, mine);
    return std::accumulate(all.begin(), all.end(), std::uint64_t{0});
  }
  std::uint64_t sum_before(std::uint64_t mine) const override {
    const auto all = of_all(meeting_.numbers, mine);
    return std::accumulate(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(number_),
                           std::uint64_t{0});
  }
  Words exchange(const Words& to_each) const override {
    Words from_each;
    for (const Words& theirs : of_all(meeting_.words, to_each)) {
      from_each.push_back(theirs[number_]);
    }
    return from_each;
  }
  void take(UnnumberedPiece&& piece, std::uint64_t) override {
    meeting_.pieces[number_] = std::move(piece);
  }
  // Asked for if features became points, which the sets below have none of.
  SurfaceTopology topology() override { throw InternalError("the topology was asked for"); }
  void keep() override {}
  std::uint64_t kept_bytes() const override { return 0; }

 private:
  // The values of all members.
  template <class T>
  std::vector<T> of_all(std::vector<T>& shared, const T& mine) const {
    shared[number_] = mine;
    meeting_.barrier.arrive_and_wait();
    std::vector<T> all = shared;
    meeting_.barrier.arrive_and_wait();
    return all;
  }

  Meeting& meeting_;
  std::size_t number_;
};

void mesh_by(Meeting& meeting, const SphereSet& spheres, const ExactMeshOptions& options) {
  std::vector<std::jthread> threads;
  for (std::size_t number = 0; number < meeting.numbers.size(); ++number) {
    threads.emplace_back([&, number] {
      Member member(meeting, number);
      meeting.stats[number] = mesh_union_by(member, nullptr, spheres, options);
    });
  }
}

// The vertices of all pieces in the order of the whole mesh: the runs of corners, then those of
// points of arcs, then those of interior points.
std::vector<std::vector<std::uint64_t>> numbers_of_pieces(const Meeting& meeting) {
  std::vector<std::vector<std::uint64_t>> numbers(meeting.pieces.size());
  std::uint64_t next = 0;
  for (std::size_t kind = 0; kind < 3; ++kind) {
    for (std::size_t p = 0; p < meeting.pieces.size(); ++p) {
      for (std::uint64_t i = 0; i < meeting.pieces[p].own[kind]; ++i) numbers[p].push_back(next++);
    }
  }
  return numbers;
}

void expect_mesh(const Meeting& meeting, const IndexedMesh& whole) {
  auto numbers = numbers_of_pieces(meeting);
  std::size_t vertices = 0, triangles = 0;
  for (std::size_t p = 0; p < meeting.pieces.size(); ++p) {
    const UnnumberedPiece& piece = meeting.pieces[p];
    ASSERT_EQ(piece.mesh.vertex_count(), numbers[p].size());
    EXPECT_TRUE(std::ranges::is_sorted(piece.elsewhere));
    for (std::size_t v = 0; v < numbers[p].size(); ++v) {
      const std::uint64_t number = numbers[p][v];
      ASSERT_LT(number, whole.vertex_count());
      ASSERT_EQ(piece.mesh.positions[v], whole.positions[number]) << "vertex " << number;
      ASSERT_EQ(piece.mesh.normals[v], whole.normals[number]);
      ASSERT_EQ(piece.mesh.vertex_spheres[v], whole.vertex_spheres[number]);
    }
    vertices += numbers[p].size();
    numbers[p].insert(numbers[p].end(), piece.elsewhere.begin(), piece.elsewhere.end());
    for (std::size_t t = 0; t < piece.mesh.triangle_count(); ++t, ++triangles) {
      ASSERT_LT(triangles, whole.triangle_count());
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_EQ(numbers[p].at(piece.mesh.triangles[t][k]), whole.triangles[triangles][k]);
      }
      ASSERT_EQ(piece.mesh.triangle_spheres[t], whole.triangle_spheres[triangles]);
    }
  }
  EXPECT_EQ(vertices, whole.vertex_count());
  EXPECT_EQ(triangles, whole.triangle_count());
}

// Returns whether the set was meshed in parts.
bool expect_same_by(std::size_t members, const SphereSet& spheres, double edge_length = 0.6) {
  ExactMeshOptions options;
  options.edge_length = edge_length;
  ExactMesh one;
  try {
    one = mesh_union(spheres, options);
  } catch (const LimitExceeded&) {
    return false;
  }
  if (one.stats.points + one.stats.contacts + one.stats.joins > 0) return false;
  Meeting meeting(members);
  mesh_by(meeting, spheres, options);
  expect_mesh(meeting, one.mesh);
  for (const ExactMeshStats& stats : meeting.stats) {
    EXPECT_EQ(stats.arcs, one.stats.arcs);
    EXPECT_EQ(stats.corners, one.stats.corners);
    EXPECT_EQ(stats.pieces, one.stats.pieces);
    EXPECT_EQ(stats.split, one.stats.split);
    EXPECT_EQ(stats.exact_tests, one.stats.exact_tests);
    EXPECT_EQ(stats.below_floor, one.stats.below_floor);
    EXPECT_EQ(stats.triangulated_balls, one.stats.triangulated_balls);
  }
  // Members that arrange all balls send each other no words.
  return std::ranges::any_of(meeting.words, [](const Words& w) { return !w.empty(); });
}

TEST(MeshTeam, PartsOfSetsUnlikeProteinsAreThoseOfOneProcess) {
  std::size_t in_parts = 0;
  for_sets_of_families(60, [&](const std::vector<Sphere>& balls, Dice&, unsigned seed) {
    in_parts += expect_same_by(2 + seed % 4, SphereSet(balls));
  });
  EXPECT_GT(in_parts, 15u);
}

// Pieces on a border are halved and cut for the floors of angles, by all members alike.
TEST(MeshTeam, FloorsOfAngles) {
  std::vector<SphereSet> sets{short_arc(1e-5)};
  for (const double h : {0.1, 0.2, 0.3}) {
    for (const double k : {0.2, 0.45, 0.6}) sets.push_back(strip(0.01, h, k));
  }
  for (const SphereSet& spheres : sets) {
    for (const std::size_t members : {2u, 3u, 4u}) EXPECT_TRUE(expect_same_by(members, spheres));
  }
}

// Sees how often the mesher begins with the boundaries anew after it has meshed patches.
class RestartCounter final : public Monitor {
 public:
  void begin_stage(std::string_view name, std::uint64_t) override {
    const bool is_boundary = name == "sample arcs";
    restarts += is_boundary && has_meshed_;
    has_meshed_ = !is_boundary;
  }
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return false; }

  std::size_t restarts = 0;

 private:
  bool has_meshed_ = false;
};

// How often a mesh is given up for another one, with the usual feature sizes.
std::size_t restarts(const SphereSet& spheres, double edge_length) {
  RestartCounter counter;
  const ExactMesh made = mesh_union(spheres, {.edge_length = edge_length, .monitor = &counter});
  EXPECT_EQ(made.stats.arc_size, mesh_union(short_arc(0.1), {}).stats.arc_size);
  return counter.restarts;
}

// Splits for the floors are given up, in all members alike, and the mesh is made without them.
TEST(MeshTeam, FloorsThatAreGivenUp) {
  const SphereSet spheres = near_pencil();
  EXPECT_EQ(restarts(spheres, 0.5), 1u);
  EXPECT_EQ(restarts(short_arc(1e-5), 0.5), 0u);
  for (const std::size_t members : {2u, 3u, 4u}) {
    EXPECT_TRUE(expect_same_by(members, spheres, 0.5));
  }
}

// While angles are enlarged, a lack of memory is an error, as elsewhere. It must not lead to a mesh
// without floors, which members with more memory together would not make.
TEST(MeshTeam, FloorsDoNotDependOnMemory) {
  std::size_t refused = 0, made = 0;
  for (const SphereSet& spheres : {short_arc(1e-5), strip(0.01, 0.2, 0.45)}) {
    ExactMeshOptions options;
    options.edge_length = 2;
    const std::uint64_t all = hash(mesh_union(spheres, options).mesh).positions;
    for (double limit = 1e6; limit > 1e3; limit /= 1.01) {
      options.memory_limit = static_cast<std::uint64_t>(limit);
      try {
        EXPECT_EQ(hash(mesh_union(spheres, options).mesh).positions, all) << options.memory_limit;
        ++made;
      } catch (const LimitExceeded&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 0u);
  EXPECT_GT(made, 0u);
}

bool fits(const SphereSet& spheres, const ExactMeshOptions& options) {
  try {
    mesh_union(spheres, options);
    return true;
  } catch (const LimitExceeded&) {
    return false;
  }
}

// The least memory limit with which one process makes the mesh, but for some percent.
std::uint64_t least_limit(const SphereSet& spheres, ExactMeshOptions options) {
  std::uint64_t low = 0, high = std::uint64_t{1} << 30;
  while (high - low > low / 32 + 1) {
    options.memory_limit = (low + high) / 2;
    (fits(spheres, options) ? high : low) = options.memory_limit;
  }
  return high;
}

// How many of the members fail.
std::size_t failures_by(std::size_t members, const SphereSet& spheres,
                        const ExactMeshOptions& options) {
  Meeting meeting(members);
  std::vector<std::uint8_t> failed(members, 0);
  std::vector<std::jthread> threads;
  for (std::size_t number = 0; number < members; ++number) {
    threads.emplace_back([&, number] {
      Member member(meeting, number);
      try {
        mesh_union_by(member, nullptr, spheres, options);
      } catch (const LimitExceeded&) {
        failed[number] = 1;
      }
    });
  }
  threads.clear();
  return static_cast<std::size_t>(std::ranges::count(failed, 1));
}

// 200 balls at one place are much work to arrange, and have the triangles of one. So the part of
// the other member has nearly all triangles, and does not fit a limit that half of them fit; shares
// of an arrangement of all balls are cut by the areas of patches.
TEST(MeshTeam, MembersWhosePartsDoNotFitArrangeAllBalls) {
  std::vector<Sphere> balls(200, {{0, 0, 0}, 1});
  for (int i = 1; i < 40; ++i) balls.push_back({{10.0 * i, 0, 0}, 1});
  const SphereSet spheres(balls);
  ExactMeshOptions options;
  options.edge_length = 2;
  const std::uint64_t least = least_limit(spheres, options);
  options.memory_limit = least * 13 / 20;
  EXPECT_FALSE(fits(spheres, options));
  EXPECT_EQ(failures_by(2, spheres, options), 0u);
  // Half of the triangles do not fit: all members say so.
  options.memory_limit = least * 2 / 5;
  EXPECT_EQ(failures_by(2, spheres, options), 2u);
}

TEST(MeshTeam, OneBallAndMoreMembersThanBalls) {
  EXPECT_TRUE(expect_same_by(3, SphereSet({{{0, 0, 0}, 1.5}})));
  EXPECT_TRUE(expect_same_by(7, SphereSet({{{0, 0, 0}, 1.5}, {{1, 0.5, 0}, 1.5}})));
}

}  // namespace
}  // namespace vdwmesh::testing
