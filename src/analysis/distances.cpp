// Distances between a triangle mesh and the boundary of a union of balls, in both directions.
//
// "Surface" means the boundary of the union in this file, never the mesh. distances() takes these
// steps:
//  1. plan_distances() checks the input and the memory limit before any array is allocated.
//  2. ExposedSurface builds the surface exactly, as one patch for each exposed sphere.
//  3. Mesh to surface: MeshSampler chooses points on the mesh by stratified sampling of its area,
//     and SurfaceFinder finds the distance of each of them to the surface.
//  4. Surface to mesh: surface_to_mesh() takes points of spherical Fibonacci lattices on the
//     patches, and MeshFinder finds the nearest triangle for each of them.
//
// Many points count for the maximum alone. The finders pass over those that cannot raise the
// largest distance found so far, by any thread. Which these are depends on the threads, the maximum
// does not.
//
// Work is divided into blocks of fixed size. Each block has its own sums, which are joined in the
// order of the blocks; histograms count integers. The result is therefore the same bit for bit for
// any number of threads.
#include "analysis/distances.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "analysis/distances_plan.hpp"
#include "analysis/distances_samples.hpp"
#include "analysis/distances_statistics.hpp"
#include "analysis/exposed_surface.hpp"
#include "analysis/mesh_area.hpp"
#include "analysis/mesh_finder.hpp"
#include "analysis/signed_distance.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

// Returns 1 for each vertex that is on some triangle, 0 for isolated vertices. Several threads may
// mark the same vertex at the same time, so the marks are stored atomically.
Buffer<std::uint8_t> used_vertices(const IndexedMesh& mesh) {
  Buffer<std::uint8_t> used(mesh.vertex_count(), 0);
  for_each_index(mesh.triangle_count(), [&](std::size_t t) {
    for (const std::uint32_t v : mesh.triangles[t])
      std::atomic_ref(used[v]).store(1, std::memory_order_relaxed);
  });
  return used;
}

// Collects the distances of all blocks: sums for each block, which are joined in the order of the
// blocks, and a histogram for each thread, whose integer counts can be added in any order.
// histogram() returns the one of the calling thread. largest() is the largest distance that a
// thread has told of by raise(), at most that of all blocks.
class Statistics {
 public:
  explicit Statistics(std::size_t blocks) : blocks_(blocks) {}
  DistanceSums& block(std::size_t i) { return blocks_[i]; }
  DistanceHistogram& histogram() { return histograms_.local(); }
  double largest() const { return largest_.load(std::memory_order_relaxed); }
  void raise(double distance) {
    double old = largest();
    while (old < distance &&
           !largest_.compare_exchange_weak(old, distance, std::memory_order_relaxed)) {
    }
  }
  // Adds points to the maximum alone; largest_of(least) returns the larger of `least` and their
  // largest distance.
  template <class LargestOf>
  void add_extremes(std::size_t block, std::size_t count, const LargestOf& largest_of) {
    const double found = largest_of(largest());
    blocks_[block].add_extremes(count, found);
    raise(found);
  }
  DistanceStatistics result() const {
    DistanceHistogram all;
    for (const DistanceHistogram& h : histograms_) all.add(h);
    return summarize(blocks_, all);
  }

 private:
  std::vector<DistanceSums> blocks_;
  std::atomic<double> largest_{0};
  tbb::enumerable_thread_specific<DistanceHistogram> histograms_;
};

// Distances from the mesh to the surface.
//
// MeshArea maps the interval [0, A], with A the area of the mesh, onto the mesh such that equal
// lengths become equal areas: each triangle has a subinterval as long as its area, and
// point_of_triangle() turns the position within it into a point. One random number therefore gives
// a point that is uniformly distributed over the mesh. AreaStrata takes one from each of many equal
// parts of the interval. Every part of the mesh is thus sampled in proportion to its area, and
// triangles smaller than a stratum have their share too.
//
// Vertices and triangle centres are measured as well, but count only for the maximum, because they
// are not distributed by area.
class MeshSampler {
 public:
  MeshSampler(const IndexedMesh& mesh, const SurfaceFinder& finder, const DistanceOptions& options)
      : mesh_(mesh),
        finder_(finder),
        area_(mesh),
        strata_(plan_mesh_samples(area_.total(), options)) {}

  DistanceStatistics run(Monitor* monitor) const {
    const std::size_t triangles = mesh_.triangle_count(), vertices = mesh_.vertex_count();
    const std::size_t sample_blocks = block_count(strata_.samples, kDistancesPerBlock);
    const std::size_t face_blocks = block_count(triangles, kDistancesPerBlock);
    const std::size_t blocks =
        sample_blocks + face_blocks + block_count(vertices, kDistancesPerBlock);
    const Buffer<std::uint8_t> used = used_vertices(mesh_);
    Statistics statistics(blocks);
    begin_stage(monitor, "distances of the mesh", blocks);
    const auto visit = [&](std::size_t count, const auto& body) {
      for_each_block(count, kDistancesPerBlock, body, monitor);
    };
    visit(strata_.samples, [&](std::size_t block, std::size_t first, std::size_t end) {
      sample_area(first, end, statistics.block(block), statistics.histogram());
      statistics.raise(statistics.block(block).max);
    });
    visit(triangles, [&](std::size_t block, std::size_t first, std::size_t end) {
      add_extremes(centres(first, end), sample_blocks + block, statistics);
    });
    visit(vertices, [&](std::size_t block, std::size_t first, std::size_t end) {
      add_extremes(vertices_of(first, end, used), sample_blocks + face_blocks + block, statistics);
    });
    return statistics.result();
  }

 private:
  // Measures the samples of one block.
  void sample_area(std::uint64_t first, std::uint64_t end, DistanceSums& sums,
                   DistanceHistogram& histogram) const {
    std::vector<Vec3d> points;
    points.reserve(end - first);
    MeshArea::Cursor cursor(area_, strata_.position(first));
    for (std::uint64_t i = first; i < end; ++i)
      points.push_back(cursor.point_at(strata_.position(i)));
    for (const double distance : unsigned_distances(points)) {
      sums.add(distance);
      histogram.add(distance);
    }
  }

  // The centres of one block of triangles.
  std::vector<Vec3d> centres(std::size_t first, std::size_t end) const {
    std::vector<Vec3d> points;
    points.reserve(end - first);
    for (std::size_t t = first; t < end; ++t) points.push_back(center_of(corners_of(mesh_, t)));
    return points;
  }

  // One block of vertices, without isolated vertices, whose element of `used` is 0.
  std::vector<Vec3d> vertices_of(std::size_t first, std::size_t end,
                                 const Buffer<std::uint8_t>& used) const {
    std::vector<Vec3d> points;
    points.reserve(end - first);
    for (std::size_t v = first; v < end; ++v)
      if (used[v]) points.push_back(mesh_.positions[v]);
    return points;
  }

  // Measures points for the maximum.
  void add_extremes(std::span<const Vec3d> points, std::size_t block,
                    Statistics& statistics) const {
    statistics.add_extremes(block, points.size(),
                            [&](double least) { return finder_.largest_distance(points, least); });
  }

  std::vector<double> unsigned_distances(std::span<const Vec3d> points) const {
    std::vector<double> found(points.size());
    finder_.find(points, found.data());
    for (double& distance : found) distance = std::abs(distance);
    return found;
  }

  const IndexedMesh& mesh_;
  const SurfaceFinder& finder_;
  MeshArea area_;
  AreaStrata strata_;
};

// Distances from the surface to the mesh. Samples inside patches, with `density` points per Å²,
// enter all statistics. Exposed points on circles, and corners, enter the maximum only. The
// circles have √density points per Å, so neighbours on a circle are about as far apart as
// neighbours inside a patch.
DistanceStatistics surface_to_mesh(const ExposedSurface& surface, const MeshFinder& finder,
                                   double density, const DistanceOptions& options) {
  const std::span<const Patch> patches = surface.patches();
  const std::size_t blocks = block_count(patches.size(), kPatchesPerBlock);
  Statistics statistics(blocks);
  begin_stage(options.monitor, "distances of the surface", blocks);
  const auto visit = [&](std::size_t block, std::size_t first, std::size_t end) {
    DistanceSums& sums = statistics.block(block);
    DistanceHistogram& histogram = statistics.histogram();
    std::vector<Vec3d> inside, border;
    for (std::size_t i = first; i < end; ++i) {
      // The random stream is the rank of the sphere in canonical order, so that the samples do not
      // depend on the order of the spheres in the caller's set.
      Random random(options.seed, surface.list().rank[patches[i].place]);
      sample_patch(patches[i], density, random, [&](const Vec3d& p) { inside.push_back(p); });
      sample_border(patches[i], std::sqrt(density), random,
                    [&](const Vec3d& p) { border.push_back(p); });
    }
    std::vector<double> found(inside.size());
    finder.find(inside, found.data());
    for (const double distance : found) {
      sums.add(distance);
      histogram.add(distance);
    }
    statistics.raise(sums.max);
    statistics.add_extremes(block, border.size(),
                            [&](double least) { return finder.largest_distance(border, least); });
  };
  for_each_block(patches.size(), kPatchesPerBlock, visit, options.monitor);
  return statistics.result();
}

}  // namespace

MeshDistances distances(const IndexedMesh& mesh, const SphereSet& spheres,
                        const DistanceOptions& options) {
  // Options and input that are refused are reported before the surface is built.
  const DistancePlan plan = plan_distances(mesh, spheres, options);
  const ExposedSurface surface(spheres, options.monitor);
  // Each finder is a temporary that ends with its statement. The search tree over the patches is
  // therefore freed before the one over the triangles is built.
  const DistanceStatistics of_mesh =
      MeshSampler(mesh, SurfaceFinder(surface, plan.world), options).run(options.monitor);
  const DistanceStatistics of_surface =
      surface_to_mesh(surface, MeshFinder(mesh, plan.world), plan.surface_density, options);
  return both_ways(of_mesh, of_surface, options.seed);
}

// No memory limit is checked. The function allocates the surface, the search tree over its patches
// and one double and one float per vertex.
std::vector<float> vertex_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                                    Monitor* monitor) {
  check_points(mesh.positions, spheres, "vertex");
  const std::vector<double> exact = signed_distances(mesh.positions, spheres, monitor);
  std::vector<float> rounded(exact.size());
  std::ranges::transform(exact, rounded.begin(), [](double d) { return static_cast<float>(d); });
  return rounded;
}

}  // namespace vdwmesh
