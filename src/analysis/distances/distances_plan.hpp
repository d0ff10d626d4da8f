// What distances() decides before it measures, on the CPU and on CUDA devices alike: whether the
// arguments are accepted, how many samples there are, and which box contains everything.
#pragma once

#include "analysis/distances.hpp"
#include "analysis/distances/distances_samples.hpp"

namespace vdwmesh {

// Numbers of triangles, vertices or samples, and of patches, whose distances are added up together.
// Sums of floating-point numbers depend on this division, so every backend has it.
inline constexpr std::size_t kDistancesPerBlock = 2048;
inline constexpr std::size_t kPatchesPerBlock = 8;

struct DistancePlan {
  // The bounding box of triangles and balls together. Both search trees use it, because a BoxTree
  // needs a box around its primitives and all queries, and the queries of each tree are points of
  // the other object: mesh points ask for the nearest patch, and points of spheres for the nearest
  // triangle.
  Box world;
  double surface_density;  // samples per Å² on the spheres
};

// Checks the arguments and throws as distances() says.
DistancePlan plan_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                            const DistanceOptions& options);

// The samples on a mesh of this area, Å². Throws as distances() says.
AreaStrata plan_mesh_samples(double area, const DistanceOptions& options);

// Throws InvalidInput unless there are spheres and all points are finite. `what` says in the
// message what a point is.
void check_points(std::span<const Vec3d> points, const SphereSet& spheres, const char* what);

// The smallest box around the points and `box`.
Box box_around(Box box, std::span<const Vec3d> points);

// Samples per Å² on a surface of these spheres. Throws as distances() says.
double surface_density(const SphereSet& spheres, const DistanceOptions& options);

// Puts the two directions together.
MeshDistances both_ways(const DistanceStatistics& mesh_to_surface,
                        const DistanceStatistics& surface_to_mesh, std::uint64_t seed);

}  // namespace vdwmesh
