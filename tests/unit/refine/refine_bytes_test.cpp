// refine_bytes() against the memory that a refinement takes at most: operators new and delete of
// this program count what they give.
#include <gtest/gtest.h>
#include <malloc.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "extract/extractor.hpp"
#include "refine/crossings/preparation.hpp"
#include "refine/refiner.hpp"
#include "support/crease_meshes.hpp"
#include "support/dice.hpp"

namespace {

std::atomic<std::int64_t> taken{0}, most_taken{0};

void* take(std::size_t bytes, std::size_t alignment) {
  void* const memory =
      std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (!memory) throw std::bad_alloc();
  const std::int64_t now = taken += static_cast<std::int64_t>(malloc_usable_size(memory));
  for (std::int64_t most = most_taken;
       most < now && !most_taken.compare_exchange_weak(most, now);) {
  }
  return memory;
}

void give_back(void* memory) {
  taken -= static_cast<std::int64_t>(malloc_usable_size(memory));
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t bytes) { return take(bytes, alignof(std::max_align_t)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return take(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { give_back(memory); }

namespace vdwmesh {
namespace {

// Bytes of what does not grow with the mesh: the refiner, the counts of each level, what threads
// keep for themselves, and what the allocator adds to its blocks. No array here is as small.
constexpr std::uint64_t kSmallThings = 1 << 16;
constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();

// Balls at random, of which many moves cross others and are taken back.
SphereSet crowd() {
  testing::Dice dice(7);
  std::vector<Sphere> balls;
  for (int i = 0; i < 300; ++i) {
    const Vec3d center{dice.real(-5, 5), dice.real(-5, 5), dice.real(-5, 5)};
    balls.push_back({center, dice.real(0.3, 2)});
  }
  return SphereSet(std::move(balls));
}

IndexedMesh marching_cubes(const SphereSet& spheres) {
  ExtractOptions options;
  options.grid.spacing = 0.25;
  return make_cpu_extractor()->extract(spheres, options).mesh;
}

MeshSize size_of(const IndexedMesh& mesh) { return {mesh.vertex_count(), mesh.triangle_count()}; }

RefineOptions options_of(int subdivisions, Projection projection, Normals normals,
                         std::uint64_t half_edges_up_to) {
  RefineOptions options;
  options.subdivisions = subdivisions;
  options.projection = projection;
  options.normals = normals;
  options.half_edges_up_to = half_edges_up_to;
  return options;
}

// The most bytes that a refinement takes beside its arguments.
std::uint64_t most_bytes(const SphereSet& spheres, const IndexedMesh& mesh,
                         const RefineOptions& options) {
  const auto refiner = make_cpu_refiner();
  const std::int64_t before = taken;
  most_taken = before;
  const RefineResult result = refiner->refine(spheres, mesh, options);
  EXPECT_EQ(result.mesh.triangle_count(),
            subdivided(size_of(mesh), options.subdivisions).triangles);
  return static_cast<std::uint64_t>(most_taken - before);
}

// With normals or without, with all half-edges or those of the last level left out.
void expect_bounds(const SphereSet& spheres, const IndexedMesh& mesh, int subdivisions,
                   Projection projection) {
  for (const Normals normals : {Normals::none, Normals::gradients}) {
    for (const std::uint64_t up_to : {std::uint64_t{0}, kAll}) {
      const RefineOptions options = options_of(subdivisions, projection, normals, up_to);
      const std::uint64_t bytes =
          refine_bytes(size_of(mesh), spheres.size(), options, mesh.triangle_labels());
      EXPECT_LE(most_bytes(spheres, mesh, options), bytes + kSmallThings)
          << subdivisions << " subdivisions, normals " << static_cast<int>(normals)
          << ", half-edges up to " << up_to;
    }
  }
}

// With as many threads as machines have, or more than this one.
TEST(RefineBytes, AreWhatIsTakenAtMost) {
  const tbb::global_control many(tbb::global_control::max_allowed_parallelism, 16);
  const SphereSet spheres = crowd();
  const IndexedMesh mesh = marching_cubes(spheres);
  // What the first call takes for good is not the refinement's.
  most_bytes(spheres, mesh, {});
  for (const int threads : {1, 2, 16}) {
    SCOPED_TRACE(std::to_string(threads) + " threads");
    tbb::task_arena(threads).execute([&] {
      for (const int subdivisions : {0, 1, 2}) {
        for (const Projection projection : {Projection::none, Projection::vdw}) {
          expect_bounds(spheres, mesh, subdivisions, projection);
        }
      }
    });
  }
}

// A thread of its own looks at all cells, so it keeps what any thread may keep.
TEST(RefineBytes, CountWhatEachThreadKeeps) {
  const SphereSet spheres = crowd();
  const IndexedMesh mesh = marching_cubes(spheres);
  most_bytes(spheres, mesh, {});
  for (const int subdivisions : {1, 2}) {  // without any, nothing moves
    const RefineOptions options = options_of(subdivisions, Projection::vdw, Normals::none, 0);
    const auto bytes_with = [&](int threads) {
      const tbb::global_control many(tbb::global_control::max_allowed_parallelism, 16);
      return tbb::task_arena(threads).execute(
          [&] { return refine_bytes(size_of(mesh), spheres.size(), options); });
    };
    std::int64_t kept = 0;
    std::thread([&] {
      const std::int64_t before = taken;
      tbb::task_arena(1).execute([&] { most_bytes(spheres, mesh, options); });
      kept = taken - before;
    }).join();
    EXPECT_GT(kept, 1000) << "nothing is kept";
    EXPECT_LE(kept, static_cast<std::int64_t>(bytes_with(16) - bytes_with(15))) << subdivisions;
  }
}

// Here nothing is searched, so the bytes are those of the meshes. Without a projection the given
// normals are interpolated: both meshes have some.
TEST(RefineBytes, AreWhatIsTakenForLabelledTriangles) {
  testing::CreaseMesh m =
      testing::two_balls_mesh({{0.3, -0.2, 0.1}, 1.7}, {{1.5, 0.9, 0.8}, 1.5}, 120, 50);
  m.mesh.normals.assign(m.mesh.vertex_count(), {0, 0, 1});
  most_bytes(m.spheres, m.mesh, {});
  for (const int subdivisions : {1, 2, 3}) {
    for (const Projection projection : {Projection::none, Projection::vdw}) {
      expect_bounds(m.spheres, m.mesh, subdivisions, projection);
    }
  }
}

// V vertices and T triangles have V normals of 12 bytes and 3 T half-edges of 4. Level 2 of 1002
// and 2000 has 16002 and 32000, its parent 4002 and 8000.
TEST(RefineBytes, AreLessByWhatIsLeftOut) {
  const MeshSize given{1002, 2000};
  for (const TriangleLabels labels : {TriangleLabels::none, TriangleLabels::spheres}) {
    const auto bytes = [&](int subdivisions, Normals normals, std::uint64_t up_to) {
      return refine_bytes(given, 100, options_of(subdivisions, Projection::vdw, normals, up_to),
                          labels);
    };
    const std::uint64_t all = refine_bytes(given.vertices, given.triangles, 100, 2, labels);
    constexpr std::uint64_t kNormals = 12 * (16002 + 4002), kHalfEdges = 12 * 32000;
    EXPECT_EQ(bytes(2, Normals::gradients, kAll), all);
    EXPECT_EQ(bytes(2, Normals::gradients, 32000), all);
    EXPECT_EQ(bytes(2, Normals::gradients, 31999), all - kHalfEdges);
    EXPECT_EQ(bytes(2, Normals::none, kAll), all - kNormals);
    EXPECT_EQ(bytes(2, Normals::none, 0), all - kNormals - kHalfEdges);
    // The mesh that is not subdivided is the caller's.
    EXPECT_EQ(bytes(0, Normals::none, 0), bytes(0, Normals::gradients, kAll));
  }
}

// The limit counts no more than that, and its message names those subdivisions that fit so.
TEST(RefineBytes, WhatIsLeftOutNeedNotFit) {
  const MeshSize given{1002, 2000};
  RefineOptions options = options_of(2, Projection::vdw, Normals::none, 0);
  options.memory_limit = refine_bytes(given, 100, options);
  EXPECT_NO_THROW(check_refinement_size(100, given.vertices, given.triangles, options));
  options.subdivisions = 3;
  try {
    check_refinement_size(100, given.vertices, given.triangles, options);
    FAIL() << "level 3 does not fit where level 2 just does";
  } catch (const LimitExceeded& error) {
    EXPECT_NE(std::string(error.what()).find("at most 2 subdivisions"), std::string::npos)
        << error.what();
  }
  options.subdivisions = 2;
  options.normals = Normals::gradients;
  EXPECT_THROW(check_refinement_size(100, given.vertices, given.triangles, options), LimitExceeded);
}

}  // namespace
}  // namespace vdwmesh
