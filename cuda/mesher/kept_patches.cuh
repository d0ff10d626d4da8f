// Patches that a device has meshed and keeps until all vertices of the mesh have their numbers.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "creases/patch/patch_mesher.hpp"
#include "cuda/mesher/mesh_patches.cuh"

namespace vdwmesh::mesher {

// The patches of a batch in device memory, one after another, in the order of the batch.
struct KeptBatch {
  std::vector<ResultOffsets> offsets;        // where each patch begins; the last are the ends
  std::vector<std::uint64_t> first_sources;  // as in PatchBatch
  DeviceArray<Vec3d> interior;
  DeviceArray<std::array<std::uint32_t, 3>> triangles;
  DeviceArray<PointSource> sources;

  std::uint64_t bytes() const { return interior.bytes() + triangles.bytes() + sources.bytes(); }
  // The arrays outlive the stream.
  void outlive_stream() {
    interior.give_back_on(nullptr);
    triangles.give_back_on(nullptr);
    sources.give_back_on(nullptr);
  }
};

// A deque, so that threads may add batches while others are filled.
using KeptBatches = std::deque<KeptBatch>;

// PatchJob::kept: patch `index` of batch `batch`.
struct KeptName {
  std::uint32_t batch, index;
  std::uint64_t packed() const { return std::uint64_t{batch} << 32 | index; }
  static KeptName of(std::uint64_t packed) {
    return {static_cast<std::uint32_t>(packed >> 32), static_cast<std::uint32_t>(packed)};
  }
};

}  // namespace vdwmesh::mesher
