// A surface that all ranks make together: each makes the triangles of a run of bricks. The pieces
// of all ranks, one behind the other, are the mesh that one process makes, bit for bit. No rank
// holds the whole mesh.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cuda/backend_choice.hpp"
#include "distributed/ranks.hpp"
#include "distributed/together/vertex_numbers.hpp"
#include "extract/extractor.hpp"

namespace vdwmesh {

// What one rank makes of a surface: some vertices and triangles of the whole mesh, with their
// numbers in it.
struct SurfacePiece {
  MeshSize whole;                    // of the mesh of all ranks
  std::uint64_t first_triangle = 0;  // the number of triangles[0] in the whole mesh
  VertexNumbers numbers;
  // The own vertices in the order of their numbers. A corner of a triangle below their count n is
  // one of them, and corner n + i is the vertex elsewhere[i] of another rank. Labels are numbers of
  // spheres in the whole set. There is no `opposite`.
  IndexedMesh mesh;
  // Whether triangles have labels; a rank without triangles cannot tell.
  TriangleLabels labels = TriangleLabels::none;
  // Numbers of the vertices of other ranks that triangles of this piece have. They ascend: vertices
  // are searched in them by bisection.
  std::vector<std::uint64_t> elsewhere;

  // The number in the whole mesh of a corner of a triangle.
  std::uint64_t number_of(std::uint32_t corner) const {
    const std::size_t own = numbers.own();
    return corner < own ? numbers.number_of(corner) : elsewhere[corner - own];
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
// The mesh does not depend on the number of ranks, nor on `memory`, a mesh whose memory the new one
// takes over. Collective.
SurfacePiece mesh_together(const Ranks& ranks, const SphereSet& spheres, ExtractOptions options,
                           Backend backend, IndexedMesh memory = {});

}  // namespace vdwmesh
