// The crease-exact mesher with a CUDA device for its patches. Two entries share it: one whose mesh
// is the host's, and exact_mesh_on_device(), for which balls and mesh are on the device.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cuda/cuda_backend.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/memory/device_mesh.cuh"
#include "cuda/memory/fetch_values.cuh"
#include "cuda/mesher/cuda_patch_device.cuh"
#include "cuda/on_device.hpp"
#include "cuda/refine/device_refinement.cuh"
#include "cuda/spheres/device_frames.cuh"
#include "refine/crossings/preparation.hpp"

namespace vdwmesh {
namespace {

class CudaExactMesher final : public ExactMesher {
 public:
  ExactMesh mesh(const SphereSet& spheres, const ExactMeshOptions& options) const override {
    mesher::CudaPatchDevice device(options.device_memory, false);
    return mesh_union_with(&device, spheres, options);
  }
};

SphereSet download_balls(const DeviceFrames::Data& balls) {
  return SphereSet(fetch_values(balls.rows.data(), balls.atoms, balls.work()));
}

struct MeshThere {
  DeviceMesh mesh;
  ExactMeshStats stats;
  std::string fallback;
};

// The mesh before its refinement. Its arrays are given back in the order of the balls' stream.
MeshThere mesh_there(const DeviceFrames::Data& balls, const ExactMeshOptions& options) {
  mesher::CudaPatchDevice device(options.device_memory, true);
  const ExactMesh made = mesh_union_with(&device, download_balls(balls), options);
  std::optional<DeviceMesh> kept = device.take_mesh();
  std::string fallback = made.fallback;
  if (!kept) {
    require_device_memory(indexed_mesh_bytes(made.mesh), "the mesh", options.device_memory);
    kept = upload_mesh(made.mesh, balls.work());
    if (fallback.empty()) fallback = "the CPU put the mesh together: features became points";
  }
  kept->give_back_on(balls.work().get());
  return {std::move(*kept), made.stats, fallback};
}

RefineOptions without_limit(const RefineOptions& given) {
  RefineOptions options = given;
  options.memory_limit = kNoMemoryLimit;
  return options;
}

DeviceRefinement refine_there(const DeviceFrames::Data& balls, DeviceMesh mesh,
                              const RefineOptions& options) {
  check_refinement_size(balls.atoms, mesh.vertex_count(), mesh.triangle_count(), options,
                        TriangleLabels::spheres);
  begin_stage(options.monitor, "refine", static_cast<std::uint64_t>(options.subdivisions) + 1);
  // A projection makes normals anew; without one they are interpolated.
  if (options.projection != Projection::none || options.normals == Normals::none) {
    mesh.normals = DeviceArray<Vec3f>();
  }
  const DeviceSurface surface(balls, options, TriangleLabels::spheres);
  return refine_on_device(surface.view(), std::move(mesh), options, balls.work());
}

}  // namespace

std::unique_ptr<ExactMesher> make_cuda_exact_mesher() {
  return std::make_unique<CudaExactMesher>();
}

CudaExactMesh exact_mesh_on_device(const DeviceFrames& spheres, const ExactMeshOptions& exact,
                                   const RefineOptions& refine) {
  if (spheres.valid_frames() == 0) throw InvalidFrame(*spheres.invalid());
  const DeviceFrames::Data& balls = spheres.data();
  const RefineOptions options = without_limit(refine);
  const bool refines = options.subdivisions != 0;
  // What is wrong with the options is said before the mesh is made.
  if (refines) check_refinement_size(balls.atoms, 0, 0, options, TriangleLabels::spheres);
  const DeviceScope scope(balls.device);
  MeshThere made = mesh_there(balls, exact);
  DeviceRefinement refined;
  if (refines) {
    refined = refine_there(balls, std::move(made.mesh), options);
  } else {
    refined.mesh = std::move(made.mesh);
    if (refine.normals == Normals::none) refined.mesh.normals = DeviceArray<Vec3f>();
  }
  refined.mesh.opposite = DeviceArray<std::uint32_t>();
  balls.work().wait();
  return {kept_mesh(balls.device, std::move(refined.mesh)), made.stats, std::move(refined.levels),
          std::move(made.fallback)};
}

}  // namespace vdwmesh
