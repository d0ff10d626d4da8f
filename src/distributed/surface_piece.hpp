// A surface that all ranks make together: each makes the triangles of a run of bricks, and all of
// them stand behind each other as the mesh that one process makes, bit for bit. No rank holds the
// whole mesh.
#pragma once

#include <cstdint>
#include <string>

#include "cuda/backend.hpp"
#include "distributed/ranks.hpp"
#include "extract/extractor.hpp"

namespace vdwmesh {

// What one rank makes of a surface.
struct SurfacePiece {
  MeshSize whole;  // of the mesh of all ranks
  MeshSize first;  // vertices and triangles of the ranks before this one
  // positions[0] is vertex first.vertices of the whole mesh, triangles[0] is triangle
  // first.triangles. Corners of triangles are numbers of vertices of the whole mesh, and labels are
  // numbers of spheres in the whole set. There is no `opposite`. Corners are numbers modulo 2^32.
  IndexedMesh mesh;
  // No triangle of the piece names a vertex below this one, or 2^32 or more above it.
  std::uint64_t lowest_named = 0;

  // The number of a vertex in the whole mesh, from what a triangle of the piece calls it.
  std::uint64_t number_of(std::uint32_t name) const {
    return lowest_named + (name - static_cast<std::uint32_t>(lowest_named));
  }
  // Clamped vertices, clipped cells and unmatched faces of all ranks together; the rest is of this
  // rank.
  ExtractStats stats;
  // If the CPU made the part of a rank although a device was asked for: the reason of the lowest
  // such rank. Else empty.
  std::string fallback{};
};

// Makes the surface of the spheres, of which every rank has all, by marching cubes. The options are
// those of an extraction and must be the same on all ranks; their connectivity and frame are not
// looked at, and `memory_limit` is that of one rank. Each rank meshes with this backend; ranks on
// one host take its CUDA devices in turn. Throws, on all ranks, what Extractor::extract() throws.
// The mesh does not depend on the number of ranks. Collective.
SurfacePiece mesh_together(const Ranks& ranks, const SphereSet& spheres, ExtractOptions options,
                           Backend backend);

}  // namespace vdwmesh
