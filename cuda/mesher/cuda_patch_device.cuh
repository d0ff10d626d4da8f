// The device of the crease-exact mesher (PatchDevice) on a CUDA device.
//
// If there are many boundaries, the device looks at them first (boundary_looks.cuh). The host
// settles which of their pieces are split. Patches whose boundaries have come to rest go to the
// device in batches, as large as the free memory of the device allows: a quarter of it for each.
// Two threads bring them there, each with a stream of its own: while the device meshes one batch,
// another is packed or travels. The host meshes what is left. The device keeps its patches
// until the host has numbered all vertices; then it writes them into the mesh (mesh_parts.cuh):
// part by part, or, if the mesh stays on the device, at once. A part is a run of vertices and
// triangles, which travels to the host in one piece for each array. Once half of the memory is full
// of kept patches, the following batches travel to the host at once, which writes their patches as
// its own: so a mesh for the host need not fit the device.
#pragma once

#include <tbb/task_arena.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "creases/share/patch_batch.hpp"
#include "creases/share/patch_device.hpp"
#include "cuda/mesher/batch_rooms.cuh"
#include "cuda/mesher/kept_patches.cuh"

namespace vdwmesh::mesher {

// Memory of the host for a batch on its way.
struct HostRoom {
  bool is_taken = false;
  KeptRoom<std::byte> input;
  KeptRoom<PointSource> sources;
  KeptRoom<PatchOutcome> outcomes;
  KeptRoom<PieceSplit> splits;
  // For a batch that the device does not keep.
  KeptRoom<Vec3d> interior;
  KeptRoom<std::array<std::uint32_t, 3>> triangles;
};

// For one mesh. Computes on the device that is current where it is made, whatever thread calls it.
class CudaPatchDevice final : public PatchDevice {
 public:
  // With up to so many bytes of the device's memory. `keeps_mesh`: PatchDevice::keeps_mesh().
  CudaPatchDevice(std::uint64_t most_bytes, bool keeps_mesh);
  ~CudaPatchDevice() override;

  void look(const LookOrder& order) override;
  std::size_t threads() const override { return rooms_.size(); }
  void mesh(const PatchOrder& order) override;
  std::uint64_t batches() const override { return kept_.size(); }
  void place(const PatchPlaces& all, IndexedMesh& mesh) override;
  bool keeps_mesh() const override { return keeps_mesh_; }
  void assemble(const MeshToAssemble& parts) override;
  void forget() override;

  // The mesh that assemble() has made last; its arrays are given back on the default stream. Empty
  // if there is none.
  std::optional<DeviceMesh> take_mesh() { return std::exchange(assembled_, std::nullopt); }

 private:
  std::uint64_t memory() const;
  DeviceShares shares();
  HostRoom& take_room();
  template <class Work>
  void for_each(std::size_t count, const Work& work);

  std::uint64_t most_bytes_;
  bool keeps_mesh_;
  int device_ = 0;
  tbb::task_arena packing_{tbb::task_arena::automatic, 1, tbb::task_arena::priority::high};
  std::atomic<std::uint64_t> kept_bytes_ = 0;
  std::optional<DeviceMesh> assembled_;

  std::mutex mutex_;               // for what follows, while there are several threads
  std::array<HostRoom, 2> rooms_;  // for the threads
  std::optional<DeviceShares> shares_;
  KeptBatches kept_;  // empty for batches that went to the host
};

}  // namespace vdwmesh::mesher
