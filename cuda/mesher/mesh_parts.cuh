// Writes patches that the device keeps into a mesh: section by section into a mesh in host memory,
// or at once into a mesh in device memory.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "creases/share/patch_device.hpp"
#include "cuda/mesher/kept_patches.cuh"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::mesher {

// Consecutive patches that the device keeps, and how many vertices and triangles the mesh has from
// the first of these patches to the last one, with those of other patches between them.
struct MeshSection {
  std::span<const PatchPlace> patches;
  std::uint64_t vertices, triangles;

  explicit MeshSection(std::span<const PatchPlace> some);
  std::uint64_t device_bytes() const;
};

// A section takes up to so many bytes on the device, which are some four million triangles: so
// sections travel while others are written, and each transfer is long.
inline constexpr std::uint64_t kMostSectionBytes = std::uint64_t{160} << 20;

// Sections of up to so many bytes, but of one patch at least.
std::vector<MeshSection> sections_of(std::span<const PatchPlace> patches, std::uint64_t most_bytes);

// Writes one section of a mesh on the host, by way of device memory. What lies between its patches
// becomes zeros. `first_vertices` is on the device; it and `unit` are as in PatchPlaces.
void write_section(const MeshSection& section, const KeptBatches& batches,
                   const std::uint32_t* first_vertices, double unit, IndexedMesh& mesh,
                   const Stream& stream);

// Makes a whole mesh in device memory, PatchDevice::assemble(), and the bytes of device memory that
// this takes beside the kept patches.
std::uint64_t assembly_bytes(const MeshToAssemble& parts);
DeviceMesh assemble_mesh(const MeshToAssemble& parts, const KeptBatches& batches,
                         const Stream& stream);

}  // namespace vdwmesh::mesher
