// Distances from a triangle mesh to a surface, whatever the surface is.
#pragma once

#include <functional>
#include <span>

#include "analysis/distances.hpp"

namespace vdwmesh {

// The distances of points to a surface, Å. Several threads call these at the same time. Consecutive
// points are mostly near each other.
struct PointDistances {
  // Writes the distance of each point to `found`; the sign does not matter.
  std::function<void(std::span<const Vec3d> points, double* found)> find;
  // Returns the larger of `least` and the largest distance of the points, without the sign. It may
  // pass over points whose distance is no larger than `least`.
  std::function<double(std::span<const Vec3d> points, double least)> largest;
};

// Measures the samples of distances() on the mesh, and its vertices and triangle centres for the
// maximum. The result is the same bit for bit for any number of threads. Precondition: the mesh and
// the options are as plan_distances() accepts them. Throws Cancelled on request of the monitor.
DistanceStatistics mesh_to_surface(const IndexedMesh& mesh, const PointDistances& distances,
                                   const DistanceOptions& options);

}  // namespace vdwmesh
