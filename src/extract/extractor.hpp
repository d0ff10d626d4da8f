// SphereSet -> closed welded IndexedMesh.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/monitor.hpp"
#include "extract/field.hpp"
#include "extract/grid.hpp"
#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct ExtractOptions {
  FieldOptions field;
  GridOptions grid;
  Connectivity connectivity = Connectivity::triangles;
  Normals normals = Normals::gradients;  // none: a sixth less memory where nobody looks at them
  std::uint64_t memory_limit = kNoMemoryLimit;  // bytes
  Monitor* monitor = nullptr;
  MeshSizeObserver on_size;  // may be empty; called once all is counted, before the mesh is made
  // For the CUDA backend; the mesh does not depend on them. What does not fit in `device_memory`
  // bytes (or in what is free) is made in slabs, runs of bricks; the slabs are shared among
  // `devices`, and where there are fewer of them, some work for several.
  std::uint64_t device_memory = kNoMemoryLimit;
  int devices = 1;
};

struct ExtractStats {
  std::uint64_t surface_bricks = 0;
  std::uint64_t clamped_vertices = 0;  // edge parameter clamped to [2^-20, 1 - 2^-20]
  std::uint64_t grid_clipped = 0;      // cells of the virtual border layer that hold surface
  std::uint64_t slabs = 0;             // in which CUDA made the mesh on the host
  double field_seconds = 0;            // bounds, node signs and counts
  double extract_seconds = 0;          // vertices and triangles
  double download_seconds = 0;         // from the device, where CUDA made them
};

struct ExtractResult {
  IndexedMesh mesh;
  GridSpec grid;
  ExtractStats stats;
  std::string fallback{};  // why the CPU did what a device was to do; empty: it did not
};

// Marching cubes over the bricks that the surface crosses. The mesh is closed, 2-manifold and
// oriented outwards on every input; vertices are grid edges, so nothing is welded afterwards.
// Index arrays and labels are the same for every backend and any number of threads.
class Extractor {
 public:
  virtual ~Extractor() = default;
  // Throws InvalidInput (options, no spheres), LimitExceeded (vertices, bytes), Cancelled.
  virtual ExtractResult extract(const SphereSet& spheres, const ExtractOptions& options) const = 0;
};

// The CPU backend: all cores, through TBB.
std::unique_ptr<Extractor> make_cpu_extractor();

}  // namespace vdwmesh
