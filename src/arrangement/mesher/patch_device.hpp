// Meshes many patches at once, in place of the host's threads. The CUDA backend is one
// (cuda/mesher/). UnionMesher gives it patches whose boundaries are triangulated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "arrangement/exact_mesher.hpp"
#include "arrangement/mesher/mesh_team.hpp"
#include "arrangement/mesher/patch_mesher.hpp"

namespace vdwmesh {

struct PatchJob {
  const PatchProgress* progress;  // with a triangulation, and without chains since
  double edge_length;             // as in PatchOptions
  double area;                    // of the patch, in squared radii: roughly how many triangles
  Demand demand;
  PatchMesh* mesh;       // takes the result of stage PatchStage::triangles
  bool is_done = false;  // whether the device has meshed it
  // Whether the device keeps the points and triangles for place(), in place of *mesh; then their
  // numbers.
  bool is_kept = false;
  std::uint32_t interior = 0, triangles = 0;
};

// Where a kept patch goes in the mesh.
struct PatchPlace {
  std::uint32_t job;
  std::uint32_t boundary_points;  // of the patch
  Sphere sphere;
  SphereId id;
  std::uint64_t first_vertex, first_triangle;  // of its interior points, of its triangles
};

struct PatchPlaces {
  std::span<const PatchPlace> places;  // ascending by job, by vertex and by triangle
  double unit;                         // of the spheres' lengths, in Å: a power of two
  // Writes the mesh vertices of the boundary points of place i. Called once for each, from any
  // thread.
  std::function<void(std::size_t i, std::span<std::uint32_t>)> boundary_vertices;
};

class PatchDevice {
 public:
  virtual ~PatchDevice() = default;
  // Meshes jobs as mesh_patch() would, bit by bit, and sets is_done for them. It leaves out those
  // that double precision does not decide or that outgrow their memory. What it keeps stays until
  // the next call. Throws Cancelled, DeviceMemoryExceeded.
  virtual void mesh(std::span<PatchJob> jobs, Monitor* monitor) = 0;
  // Writes kept patches of the last call of mesh() to their places in the mesh, which has room for
  // them, and to no others. Throws DeviceMemoryExceeded.
  virtual void place(const PatchPlaces& places, IndexedMesh& mesh) = 0;
};

// mesh_union() with a device for the patches, or without (null).
ExactMesh mesh_union_with(PatchDevice* device, const SphereSet& spheres,
                          const ExactMeshOptions& options);
// The same by several processes: each has all spheres, and the team gets its piece of the mesh that
// mesh_union() makes. The memory limit and the monitor are those of a process. Throws in all
// processes.
ExactMeshStats mesh_union_by(MeshTeam& team, PatchDevice* device, const SphereSet& spheres,
                             const ExactMeshOptions& options);

}  // namespace vdwmesh
