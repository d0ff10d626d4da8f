// Meshes many patches at once, in place of the host's threads. The CUDA backend is one
// (cuda/mesher/). UnionMesher gives it patches whose boundaries are triangulated.
#pragma once

#include <cstddef>
#include <cstdint>
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
};

class PatchDevice {
 public:
  virtual ~PatchDevice() = default;
  // The host is quicker with fewer jobs.
  virtual std::size_t least_jobs() const = 0;
  // Meshes jobs as mesh_patch() would, bit by bit, and sets is_done for them. It leaves out those
  // that double precision does not decide or that outgrow their memory. Throws Cancelled,
  // DeviceMemoryExceeded.
  virtual void mesh(std::span<PatchJob> jobs, Monitor* monitor) = 0;
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
