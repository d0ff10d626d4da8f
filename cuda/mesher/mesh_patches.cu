// Meshes each patch with one thread, which runs the same steps as the host, in memory of its own in
// global memory. So the bits are the host's. What is parallel is the patches: a molecule has one
// for nearly every atom.
#include <new>

#include "creases/plane/bounded_patch.hpp"
#include "cuda/memory/launch.cuh"
#include "cuda/mesher/mesh_patches.cuh"

namespace vdwmesh::mesher {
namespace {

// Threads of a block, and blocks of a multiprocessor (docs/exact_mesh.md): with more of these,
// threads have too few registers.
constexpr unsigned kThreads = 64, kBlocks = 12;
static_assert(kThreads * sizeof(PatchDesk) <= 48 * 1024, "what a block may have without asking");

// Meshes one patch per thread, on the first `per_warp` lanes of each warp; 2 warps per thread
// block, with a desk for each patch in shared memory. In a thread's own memory the words of 32
// lanes lie side by side, so the desk of one lane would take as much of the cache as 32.
// patches_per_warp() says why not all lanes have a patch.
__global__ void __launch_bounds__(kThreads, kBlocks)
    mesh_bounded_patches(const BoundedPatch* patches, std::uint32_t count, PatchMemory memory,
                         PatchOutcome* outcomes, unsigned per_warp) {
  extern __shared__ __align__(16) unsigned char desks[];
  const unsigned lane = threadIdx.x % 32;
  if (lane >= per_warp) return;
  const std::uint64_t i = thread_index() / 32 * per_warp + lane;
  if (i >= count) return;
  void* const place = desks + (threadIdx.x / 32 * per_warp + lane) * sizeof(PatchDesk);
  outcomes[i] = mesh_bounded_patch(patches[i], memory, *new (place) PatchDesk);
}

template <class T>
__device__ void copy_by_warp(const T* from, std::uint32_t count, T* to, unsigned lane) {
  for (std::uint32_t k = lane; k < count; k += 32) to[k] = from[k];
}

// Copies the results of each patch behind those of the patches before it. A warp for
// each patch; no shared memory.
__global__ void copy_results(const PatchOutcome* outcomes, const ResultOffsets* offsets,
                             std::uint32_t count, GatheredPatches to) {
  const std::uint64_t i = thread_index() / 32;
  if (i >= count || outcomes[i].failure != PatchFailure::none) return;
  const unsigned lane = threadIdx.x % 32;
  const PatchOutcome& from = outcomes[i];
  copy_by_warp(from.first_interior, from.interior, to.interior + offsets[i].interior, lane);
  copy_by_warp(from.first_triangle, from.triangles, to.triangles + offsets[i].triangle, lane);
  copy_by_warp(from.first_split, from.splits, to.splits + offsets[i].split, lane);
}

// A warp for each patch. The operations are those of the host (MeshPlacement::place_patch()), so
// the bits are.
__global__ void write_patches(const PlacedPatch* patches, std::uint32_t count,
                              const std::uint32_t* first_vertices, double unit, DeviceMeshView to) {
  const std::uint64_t i = thread_index() / 32;
  if (i >= count) return;
  const unsigned lane = threadIdx.x % 32;
  const PlacedPatch& p = patches[i];
  for (std::uint32_t k = lane; k < p.interiors; k += 32) {
    const Vec3d out = p.interior[k];
    const std::uint64_t v = p.vertex + k;
    to.positions[v] = unit * (p.sphere.center + p.sphere.radius * out);
    to.normals[v] = cast<float>(out);
    to.vertex_spheres.set(v, on_sphere(p.id));
  }
  // Corner by corner, so that a warp reads and writes without gaps.
  const std::uint32_t* const corners = p.triangles->data();
  for (std::uint32_t k = lane; k < p.corners; k += 32) {
    const std::uint32_t v = corners[k];
    to.corners[3 * p.triangle + k] =
        v < p.points ? p.sources[v].vertex(first_vertices) : p.first_vertex + (v - p.points);
  }
  for (std::uint32_t t = lane; t < p.corners / 3; t += 32) {
    to.triangle_spheres[p.triangle + t] = p.id;
  }
}

__device__ void write(const BoundaryVertex& from, std::uint64_t v, const DeviceMeshView& to) {
  to.positions[v] = from.position;
  to.normals[v] = from.normal;
  to.vertex_spheres.set(v, from.label);
}

// A thread for each corner; these are the first vertices.
__global__ void place_corners(PlacedBoundary all, DeviceMeshView to) {
  const std::uint64_t i = thread_index();
  if (i >= all.corner_count) return;
  const BoundaryCorner& corner = all.corners[i];
  write(boundary_vertex(corner.position, corner.balls, all.balls), i, to);
}

// A warp for each arc. Angles are those of ArcSampling::point().
__global__ void place_arcs(PlacedBoundary all, DeviceMeshView to) {
  const std::uint64_t a = thread_index() / 32;
  if (a >= all.arc_count) return;
  const BoundaryArc& arc = all.arcs[a];
  const std::uint32_t pieces = all.pieces[a], first = arc.is_circle() ? 0 : 1,
                      fractions = all.first_fractions[a];
  for (std::uint32_t k = first + threadIdx.x % 32; k < pieces; k += 32) {
    double fraction = 0;
    if (k > 0) {
      fraction = fractions == kNoIndex ? static_cast<double>(k) / pieces
                                       : all.fractions[fractions + k - 1];
    }
    const Vec3d p = arc.at(arc.sweep * fraction);
    write(boundary_vertex(p, {arc.balls[0], arc.balls[1], kNoIndex}, all.balls),
          std::uint64_t{all.first_vertices[a]} + k - first, to);
  }
}

}  // namespace

void mesh_patches(const BoundedPatch* patches, std::uint32_t count, const PatchMemory& memory,
                  PatchOutcome* outcomes, unsigned per_warp, const Stream& stream) {
  const std::uint64_t warps = blocks_for(count, per_warp);
  LaunchShape shape = over(32 * warps, kThreads);
  shape.shared = kThreads / 32 * per_warp * sizeof(PatchDesk);
  launch("mesh_bounded_patches", mesh_bounded_patches, shape, stream, patches, count, memory,
         outcomes, per_warp);
}

void gather_patches(const PatchOutcome* outcomes, const ResultOffsets* offsets, std::uint32_t count,
                    const GatheredPatches& to, const Stream& stream) {
  launch("copy_results", copy_results, over(32 * std::uint64_t{count}, 128), stream, outcomes,
         offsets, count, to);
}

void place_patches(const PlacedPatch* patches, std::uint32_t count,
                   const std::uint32_t* first_vertices, double unit, const DeviceMeshView& part,
                   const Stream& stream) {
  launch("write_patches", write_patches, over(32 * std::uint64_t{count}, 128), stream, patches,
         count, first_vertices, unit, part);
}

void place_boundary(const PlacedBoundary& boundary, const DeviceMeshView& mesh,
                    const Stream& stream) {
  launch("place_corners", place_corners, over(boundary.corner_count, 256), stream, boundary, mesh);
  launch("place_arcs", place_arcs, over(32 * std::uint64_t{boundary.arc_count}, 256), stream,
         boundary, mesh);
}

}  // namespace vdwmesh::mesher
