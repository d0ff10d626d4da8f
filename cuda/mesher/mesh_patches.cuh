// Kernels that mesh patches (creases/plane/bounded_patch.hpp), gather what came out, and write
// it and the boundaries between patches into a mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "creases/plane/boundary_vertex.hpp"
#include "creases/plane/bounded_patch.hpp"
#include "cuda/memory/device_structures.cuh"

namespace vdwmesh::mesher {

// How many threads of a warp mesh a patch each; the others do nothing. Patches go their own ways,
// so the threads of a warp wait for each other most of the time, and few patches are best spread
// over many warps; but with many patches, more of them for each warp give a multiprocessor more to
// turn to while others wait for memory. Measured on an H200 (patches_bench):
//
//   patches   best for a warp   with the best   otherwise
//     1,905                 1            7 ms   14 ms with 8
//    60,362                 8           59 ms   164 ms with 1, 73 ms with 16
constexpr unsigned patches_per_warp(std::uint32_t patches) {
  return patches < 8192 ? 1 : (patches < 16384 ? 2 : (patches < 32768 ? 4 : 8));
}

// Meshes patches 0 .. count - 1, and writes an outcome for each.
void mesh_patches(const BoundedPatch* patches, std::uint32_t count, const PatchMemory& memory,
                  PatchOutcome* outcomes, unsigned per_warp, const Stream& stream);

// Where the results of a patch begin in the arrays of all patches.
struct ResultOffsets {
  std::uint64_t interior, triangle, split;
};
struct GatheredPatches {
  Vec3d* interior;
  std::array<std::uint32_t, 3>* triangles;
  PieceSplit* splits;
};

// Copies the results of patches without a failure out of the work memory.
void gather_patches(const PatchOutcome* outcomes, const ResultOffsets* offsets, std::uint32_t count,
                    const GatheredPatches& to, const Stream& stream);

// A patch and its place in a part of a mesh.
struct PlacedPatch {
  Sphere sphere;
  const Vec3d* interior;
  const std::array<std::uint32_t, 3>* triangles;
  const PointSource* sources;        // of the points of its boundary
  std::uint64_t vertex, triangle;    // where it begins in the part
  std::uint32_t first_vertex;        // of its interior points, in the whole mesh
  std::uint32_t points;              // how many there are on its boundary
  std::uint32_t interiors, corners;  // how many interior points and corners of triangles it has
  SphereId id;
};

// Writes patches into part of a mesh: interior points with normals and labels, and triangles, whose
// corners become vertices of the whole mesh. `first_vertices` has for each arc the number of its
// first point between its ends, and `unit` is Å for each unit of the spheres' lengths
// (PatchPlaces).
void place_patches(const PlacedPatch* patches, std::uint32_t count,
                   const std::uint32_t* first_vertices, double unit, const DeviceMeshView& part,
                   const Stream& stream);

// The corners and arcs of a whole mesh, in device memory: BoundaryArcs, and ArcSampling with
// numbered vertices.
struct PlacedBoundary {
  BallsView balls;
  const BoundaryCorner* corners;
  const BoundaryArc* arcs;
  std::uint32_t corner_count, arc_count;
  const std::uint32_t* pieces;          // of each arc
  const std::uint32_t* first_vertices;  // ArcSampling::first_vertices()
  // ArcSampling::Fractions
  const std::uint32_t* first_fractions;
  const double* fractions;
};

// Writes corners and sample points of arcs into a whole mesh, as MeshPlacement does.
void place_boundary(const PlacedBoundary& boundary, const DeviceMeshView& mesh,
                    const Stream& stream);

}  // namespace vdwmesh::mesher
