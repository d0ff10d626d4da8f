// Distances between a mesh and an exposed surface in device memory: the patches of the surface, the
// search for nearest triangles, and the kernels of the two directions, in launches of
// kDistancesPerLaunch.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/distances/distances_plan.hpp"
#include "analysis/distances/exposed_surface.hpp"
#include "analysis/distances/surface_search.hpp"
#include "core/monitor.hpp"
#include "cuda/distances/device_tree.cuh"
#include "cuda/memory/device_memory.cuh"

namespace vdwmesh::distance {

// The patches of an exposed surface in device memory.
class DeviceExposedPatches {
 public:
  DeviceExposedPatches(const ExposedSurface& surface, const Stream& stream);

  std::uint32_t size() const { return static_cast<std::uint32_t>(patches_.size()); }
  const Patch* patches() const { return patches_.data(); }
  const Sphere* balls() const { return balls_.data(); }  // of the patches
  // [patch]: the rank of its sphere in canonical order, which numbers its random stream.
  const std::uint32_t* ranks() const { return ranks_.data(); }

 private:
  DeviceArray<Patch> patches_;
  DeviceArray<Sphere> balls_;
  DeviceArray<std::uint32_t> ranks_;
  DeviceArray<Cover> covers_;
  DeviceArray<SphereCorner> corners_;
};

// A mesh and the search tree over its triangles.
struct SearchedMesh {
  SoupView mesh;
  BoxTreeView tree;
};

// Writes to `found` the distances of the points (Å), which are in the world of the tree. `reach`
// (Å, at least 0) is a guess: most points should be nearer than that. Distances do not depend on
// it.
void find_nearest_triangles(const SearchedMesh& searched, const DeviceArray<Vec3d>& points,
                            double reach, double* found, const Stream& stream);

DistanceStatistics mesh_to_surface(const SoupView& mesh, const PatchTreeView& surface,
                                   const DistanceOptions& options, const Stream& stream);

// `reach` is the guess of find_nearest_triangles().
DistanceStatistics surface_to_mesh(const DeviceExposedPatches& patches, const SearchedMesh& mesh,
                                   double density, double reach, const DistanceOptions& options,
                                   const Stream& stream);

// Writes the signed distance of each point to `found`, Å. Both are in memory of the host, and are
// copied for one launch after another, of kDistancesPerLaunch points.
void points_to_surface(std::span<const Vec3d> points, const PatchTreeView& surface, double* found,
                       Monitor* monitor, const Stream& stream);

// Distances that are measured by one launch. A whole number of blocks of kDistancesPerBlock.
inline constexpr std::uint64_t kDistancesPerLaunch = std::uint64_t{1} << 23;

}  // namespace vdwmesh::distance
