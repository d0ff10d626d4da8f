// Writes patches that the device keeps into a mesh: part by part into one in host memory, or into
// one in its own memory.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "arrangement/mesher/patch_device.hpp"
#include "cuda/mesher/kept_patches.cuh"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::mesher {

// A run of places, and how many vertices and triangles there are from the first to the last one,
// those of other patches between them included.
struct MeshPart {
  std::span<const PatchPlace> places;
  std::uint64_t vertices, triangles;

  explicit MeshPart(std::span<const PatchPlace> some);
  std::uint64_t device_bytes() const;
};

// Parts of about so many bytes on the device, some four million triangles, so that parts travel
// while others are written, and all pieces are long.
inline constexpr std::uint64_t kMostPartBytes = std::uint64_t{160} << 20;

// Parts of up to so many bytes, but of one place at least.
std::vector<MeshPart> parts_of(std::span<const PatchPlace> places, std::uint64_t most_bytes);

// Writes one part of a mesh on the host, by way of device memory. What lies between the places
// becomes zeros. `first_vertices` is on the device; it and `unit` are as in PatchPlaces.
void write_part(const MeshPart& part, const KeptBatches& batches,
                const std::uint32_t* first_vertices, double unit, IndexedMesh& mesh,
                const Stream& stream);

// Makes a whole mesh in device memory, PatchDevice::assemble(), and the bytes of device memory that
// this takes beside the kept patches.
std::uint64_t assembly_bytes(const MeshToAssemble& parts);
DeviceMesh assemble_mesh(const MeshToAssemble& parts, const KeptBatches& batches,
                         const Stream& stream);

}  // namespace vdwmesh::mesher
