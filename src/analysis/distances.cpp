// Distances between a triangle mesh and the boundary of a union of balls, in both directions.
//
// "Surface" means the boundary of the union in this file, never the mesh. distances() takes these
// steps:
//  1. plan_distances() checks the input and the memory limit before any array is allocated.
//  2. ExposedSurface builds the surface exactly, as one patch for each exposed sphere.
//  3. Mesh to surface: mesh_to_surface() chooses points on the mesh by stratified sampling of its
//     area, and SurfaceFinder finds the distance of each of them to the surface.
//  4. Surface to mesh: surface_to_mesh() takes points of spherical Fibonacci lattices on the
//     patches, and MeshFinder finds the nearest triangle for each of them.
//
// Points on the borders of patches count for the maximum alone, so a border point that cannot raise
// the maximum found so far is not measured. mesh_to_surface() does the same with the vertices and
// triangle centres of the mesh.
//
// Work is divided into blocks of fixed size. Each block has its own sums, which are joined in the
// order of the blocks; histograms count integers. The result is therefore the same bit for bit for
// any number of threads.
#include "analysis/distances.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/distances/distances_blocks.hpp"
#include "analysis/distances/distances_plan.hpp"
#include "analysis/distances/distances_samples.hpp"
#include "analysis/distances/exposed_surface.hpp"
#include "analysis/distances/mesh_finder.hpp"
#include "analysis/distances/mesh_to_surface.hpp"
#include "analysis/signed_distance.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

// Samples of a block that are kept at a time.
constexpr std::size_t kTogether = std::size_t{1} << 14;

// Distances from the surface to the mesh. Samples inside patches, with `density` points per Å²,
// enter all statistics. Exposed points on circles, and corners, enter the maximum only. The
// circles have √density points per Å, so neighbours on a circle are about as far apart as
// neighbours inside a patch.
DistanceStatistics surface_to_mesh(const ExposedSurface& surface, const MeshFinder& finder,
                                   double density, const DistanceOptions& options) {
  const std::span<const Patch> patches = surface.patches();
  const std::size_t blocks = block_count(patches.size(), kPatchesPerBlock);
  BlockStatistics statistics(blocks);
  begin_stage(options.monitor, "distances of the surface", blocks);
  const auto visit = [&](std::size_t block, std::size_t first, std::size_t end) {
    std::vector<Vec3d> inside, border;
    const auto take = [&] {
      advance(options.monitor, 0);
      statistics.add_samples(block, inside, border, finder);
      inside.clear();
      border.clear();
    };
    const auto add = [&](std::vector<Vec3d>& points, const Vec3d& p) {
      points.push_back(p);
      if (points.size() >= kTogether) take();
    };
    for (std::size_t i = first; i < end; ++i) {
      // The random stream is the rank of the sphere in canonical order, so that the samples do not
      // depend on the order of the spheres in the caller's set.
      Random random(options.seed, to_index(surface.list().rank[patches[i].place]));
      sample_patch(patches[i], density, random, [&](const Vec3d& p) { add(inside, p); });
      sample_border(patches[i], std::sqrt(density), random,
                    [&](const Vec3d& p) { add(border, p); });
    }
    take();
  };
  for_each_block(patches.size(), kPatchesPerBlock, visit, options.monitor);
  return statistics.result();
}

DistanceStatistics from_mesh(const IndexedMesh& mesh, const SurfaceFinder& finder,
                             const DistanceOptions& options) {
  const auto find = [&](std::span<const Vec3d> points, double* found) {
    finder.find(points, found);
  };
  const auto largest = [&](std::span<const Vec3d> points, double largest_so_far) {
    return finder.largest_distance(points, largest_so_far);
  };
  return mesh_to_surface(mesh, {find, largest}, options);
}

}  // namespace

MeshDistances distances(const IndexedMesh& mesh, const SphereSet& spheres,
                        const DistanceOptions& options) {
  // Options and input that are refused are reported before the surface is built.
  const DistancePlan plan = plan_distances(mesh, spheres, options);
  const ExposedSurface surface(spheres, options.monitor);
  // The search tree over the patches is freed before the one over the triangles is built. Both need
  // plan.world, the box around mesh and balls together.
  const DistanceStatistics of_mesh = from_mesh(mesh, SurfaceFinder(surface, plan.world), options);
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
