// Distances between a mesh and an exposed surface in device memory: the kernels of the two
// directions, in launches of kDistancesPerLaunch.
#pragma once

#include <span>

#include "analysis/distances_plan.hpp"
#include "analysis/surface_search.hpp"
#include "core/monitor.hpp"
#include "cuda/distances/device_patches.cuh"
#include "cuda/distances/device_tree.cuh"
#include "cuda/distances/nearest_triangles.cuh"
#include "cuda/memory/device_memory.cuh"

namespace vdwmesh::distance {

DistanceStatistics mesh_to_surface(const SoupView& mesh, const PatchTreeView& surface,
                                   const DistanceOptions& options, const Stream& stream);

// `reach` is the guess of find_nearest_triangles().
DistanceStatistics surface_to_mesh(const DevicePatches& patches, const SearchedMesh& mesh,
                                   double density, double reach, const DistanceOptions& options,
                                   const Stream& stream);

// Writes the signed distance of each point to `found`, Å. Both are in memory of the host, and are
// copied for one launch after another, of kDistancesPerLaunch points.
void points_to_surface(std::span<const Vec3d> points, const PatchTreeView& surface, double* found,
                       Monitor* monitor, const Stream& stream);

// Distances that are measured by one launch. A whole number of blocks of kDistancesPerBlock.
inline constexpr std::uint64_t kDistancesPerLaunch = std::uint64_t{1} << 23;

}  // namespace vdwmesh::distance
