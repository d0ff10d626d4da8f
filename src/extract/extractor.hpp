// SphereSet -> closed welded IndexedMesh.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/monitor.hpp"
#include "core/workspace.hpp"
#include "extract/field.hpp"
#include "extract/grid.hpp"
#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct ExtractOptions {
  FieldOptions field;
  GridOptions grid;
  // May be null: else the cells of the cell list, as make_field_frame() makes them. Throws
  // InvalidInput if a sphere lies beyond them.
  const CellListFrame* frame = nullptr;
  Connectivity connectivity = Connectivity::triangles;
  Normals normals = Normals::gradients;  // none: a sixth less memory where nobody looks at them
  std::uint64_t memory_limit = kNoMemoryLimit;  // bytes
  Monitor* monitor = nullptr;
  Workspace* workspace = nullptr;  // may be null; else keeps memory and cell list for later calls
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
  // Upper faces of bricks that the surface crosses, less lower ones. It is 0 for a whole mesh, and
  // adds up to 0 over the parts of one: else the search left out a brick that the surface needs.
  std::int64_t unmatched_faces = 0;
  std::uint64_t slabs = 0;      // in which CUDA made the mesh on the host
  double field_seconds = 0;     // bounds, node signs and counts
  double extract_seconds = 0;   // vertices and triangles
  double download_seconds = 0;  // from the device, where CUDA made them
};

struct ExtractResult {
  IndexedMesh mesh;
  GridSpec grid;
  ExtractStats stats;
  std::string fallback{};  // why the CPU did what a device was to do; empty: it did not
};

// What one range of bricks holds of a surface: counted, but not made. It needs the workspace of its
// options, if they name one, to itself as long as it lives; the spheres only until it is made.
class SurfacePart {
 public:
  virtual ~SurfacePart() = default;

  // The vertices and triangles that the bricks of the range own.
  virtual MeshSize size() const = 0;

  // Fills `mesh` with them. `first` says how many vertices and triangles the ranges before this one
  // own: corners and opposite half-edges are numbered in the whole mesh, modulo 2^32, while
  // positions[0] is vertex first.vertices and triangles[0] is triangle first.triangles. The parts
  // of ranges that join without a gap, one behind the other, are the mesh of Extractor::extract,
  // bit for bit. Numbers at or above first + size belong to the ranges behind this one.
  virtual ExtractStats emit(const MeshSize& first, IndexedMesh& mesh) = 0;
};

// Marching cubes over the bricks that the surface crosses. The mesh is closed, 2-manifold and
// oriented outwards on every input; vertices are grid edges, so nothing is welded afterwards.
// Index arrays and labels are the same for every backend and any number of threads.
class Extractor {
 public:
  virtual ~Extractor() = default;

  // Meshes into `result`, in the memory of the arrays that it has. Throws InvalidInput (options, no
  // spheres), LimitExceeded (vertices, bytes), Cancelled; `result` means nothing then.
  virtual void extract_into(ExtractResult& result, const SphereSet& spheres,
                            const ExtractOptions& options) const = 0;

  // The same into a new result.
  ExtractResult extract(const SphereSet& spheres, const ExtractOptions& options) const {
    ExtractResult result;
    extract_into(result, spheres, options);
    return result;
  }

  // The same in steps, for processes and devices that share a surface: each counts a range of
  // bricks, all add up what the ranges before theirs own, and each emits its part. A range also
  // counts the bricks around it, some two layers, and needs their spheres and those around them;
  // processes that leave out the others must all be given one grid and one frame. Throws as
  // extract() does, but does not check the size of the mesh.
  virtual std::unique_ptr<SurfacePart> count(const SphereSet& spheres, const KeyRange& range,
                                             const ExtractOptions& options) const = 0;
};

// The CPU backend: all cores, through TBB.
std::unique_ptr<Extractor> make_cpu_extractor();

}  // namespace vdwmesh
