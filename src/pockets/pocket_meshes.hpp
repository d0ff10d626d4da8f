// Meshes of pockets: of each the boundary of its room, which is where the centre of the probe can
// be. The room is the pocket's tetrahedra less all balls; its boundary is the wall, which lies on
// the balls, and the mouths, which are flat.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/errors.hpp"
#include "pockets/pockets.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct PocketMesh {
  // Closed and oriented; normals point out of the room, those of the wall into the balls. Each
  // vertex of a triangle with a sphere lies on that sphere up to rounding. Where the room touches
  // itself in an edge or a vertex, the surface has that edge or vertex twice. Empty if the room
  // could not be meshed.
  IndexedMesh mesh;
  // By triangle: 0 is the wall, m the mouth m of the pocket's list, counted from 1. Triangles of
  // mouths have no sphere.
  std::vector<std::uint32_t> parts;
};

struct PocketMeshOptions {
  double edge_length = 0.35;  // Å; shorter along the rims of small mouths
  Monitor* monitor = nullptr;
  std::uint64_t memory_limit = kNoMemoryLimit;  // bytes, of the mesh of the union
};

// The mesh of each pocket, which pockets() has found for the same spheres with
// PocketMeasures::exact. Errors of volume and area fall with the square of the edge length. Does
// not depend on the number of threads.
// Throws InvalidInput if the edge length is not finite and positive, LimitExceeded, and Cancelled.
std::vector<PocketMesh> pocket_meshes(const SphereSet& spheres, std::span<const Pocket> pockets,
                                      const PocketMeshOptions& options = {});

}  // namespace vdwmesh
