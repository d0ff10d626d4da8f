// mesh_to_surface(): the samples of a mesh, block by block.
//
// Work is divided into blocks of fixed size, and the sums of all blocks are joined in their order.
// Vertices and centres count for the maximum alone: those that cannot raise the largest distance
// found so far, by any thread, are passed over. Which these are depends on the threads, the maximum
// does not.
#include "analysis/distances/mesh_to_surface.hpp"

#include <atomic>
#include <cmath>
#include <vector>

#include "analysis/distances/distances_blocks.hpp"
#include "analysis/distances/distances_plan.hpp"
#include "analysis/survey/mesh_area.hpp"
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
  MeshSampler(const IndexedMesh& mesh, const PointDistances& distances,
              const DistanceOptions& options)
      : mesh_(mesh),
        distances_(distances),
        area_(mesh),
        strata_(plan_mesh_samples(area_.total(), options)) {}

  DistanceStatistics run(Monitor* monitor) const {
    const std::size_t triangles = mesh_.triangle_count(), vertices = mesh_.vertex_count();
    const std::size_t sample_blocks = block_count(strata_.samples, kDistancesPerBlock);
    const std::size_t face_blocks = block_count(triangles, kDistancesPerBlock);
    const std::size_t blocks =
        sample_blocks + face_blocks + block_count(vertices, kDistancesPerBlock);
    const Buffer<std::uint8_t> used = used_vertices(mesh_);
    BlockStatistics statistics(blocks);
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
                    BlockStatistics& statistics) const {
    statistics.add_extremes(block, points.size(),
                            [&](double least) { return distances_.largest(points, least); });
  }

  std::vector<double> unsigned_distances(std::span<const Vec3d> points) const {
    std::vector<double> found(points.size());
    distances_.find(points, found.data());
    for (double& distance : found) distance = std::abs(distance);
    return found;
  }

  const IndexedMesh& mesh_;
  const PointDistances& distances_;
  MeshArea area_;
  AreaStrata strata_;
};

}  // namespace

DistanceStatistics mesh_to_surface(const IndexedMesh& mesh, const PointDistances& distances,
                                   const DistanceOptions& options) {
  return MeshSampler(mesh, distances, options).run(options.monitor);
}

}  // namespace vdwmesh
