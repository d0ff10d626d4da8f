// The Extractor: makes a closed triangle mesh from spheres by marching cubes on a regular grid.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/errors.hpp"
#include "extract/field.hpp"
#include "extract/grid.hpp"
#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

class Monitor;
class Workspace;

struct ExtractOptions {
  FieldOptions field;
  GridOptions grid;
  // The cells of the cell list, as make_field_frame() makes them; null: cells made for the spheres
  // given. The extraction throws InvalidInput if a sphere does not fit the frame.
  const CellListFrame* frame = nullptr;
  Connectivity connectivity = Connectivity::triangles;
  Normals normals = Normals::gradients;         // none: the mesh takes a sixth less memory
  std::uint64_t memory_limit = kNoMemoryLimit;  // for the mesh and what is held beside it, bytes
  Monitor* monitor = nullptr;                   // progress and cancellation; may be null
  Workspace* workspace = nullptr;  // if not null, it keeps memory and the cell list for later calls
  MeshSizeObserver on_size;  // may be empty; called when the size is known, before the mesh is made
  // For the CUDA backend; the mesh does not depend on them. If the work does not fit in
  // `device_memory` bytes of each device, or in its free memory, it is divided into slabs, runs of
  // consecutive bricks. The slabs are shared among this number of devices; if the machine has
  // fewer, a device takes the slabs of several.
  std::uint64_t device_memory = kNoMemoryLimit;
  int devices = 1;
};

struct ExtractStats {
  std::uint64_t surface_bricks = 0;    // bricks that hold surface
  std::uint64_t clamped_vertices = 0;  // moved, to keep 2^-20 of their edge from its ends
  std::uint64_t grid_clipped = 0;  // cells that the surface crosses with a corner outside the grid
  // Lower faces of bricks that the surface crosses, less upper ones. The difference is 0 for a
  // whole mesh, and its sum over the parts of a mesh is 0. If it is not, the search has left out a
  // brick that holds surface.
  std::int64_t unmatched_faces = 0;
  std::uint64_t slabs = 0;      // in which CUDA made the mesh and copied it to the host; CPU: 0
  double field_seconds = 0;     // search for bricks, node signs and counts
  double extract_seconds = 0;   // making vertices and triangles
  double download_seconds = 0;  // copies from the device; 0 on the CPU

  ExtractStats& operator+=(const ExtractStats& other) {
    surface_bricks += other.surface_bricks;
    clamped_vertices += other.clamped_vertices;
    grid_clipped += other.grid_clipped;
    unmatched_faces += other.unmatched_faces;
    slabs += other.slabs;
    field_seconds += other.field_seconds;
    extract_seconds += other.extract_seconds;
    download_seconds += other.download_seconds;
    return *this;
  }
};

struct ExtractResult {
  IndexedMesh mesh;
  GridSpec grid;
  ExtractStats stats;
  // If the CPU made the mesh although a device was asked for: the reason. Else empty.
  std::string fallback{};
};

// The vertices of the bricks around a range of bricks, before it and behind it.
struct HaloVertices {
  std::uint64_t before = 0, behind = 0;
  // Of the triangles of the range, only so many of the last ones may name vertices behind it.
  // Vertices before it are named by half-edges alone.
  std::uint64_t naming_triangles = 0;
};

// The part of a surface in one range of bricks, after counting and before its mesh is made. If the
// options name a workspace, no other call may use it during the life of the SurfacePart. The
// spheres are not needed any more once Extractor::count() has returned.
class SurfacePart {
 public:
  virtual ~SurfacePart() = default;

  // The number of vertices and triangles that the bricks of the range own.
  virtual MeshSize size() const = 0;

  // How many vertices next to those of the range, in the order of numbers, its triangles and
  // half-edges may name beside them.
  virtual HaloVertices halo() const = 0;

  // Fills `mesh` with these vertices and triangles. `first` says how many vertices and triangles
  // the ranges before this one own. Numbers in the mesh are those of the whole mesh, modulo 2^32:
  // positions[0] is vertex first.vertices, triangles[0] is triangle first.triangles, and the
  // corners of triangles and the opposite half-edges are given by such numbers. A number below
  // those of this part, or above them, names a vertex or half-edge in another range. If ranges
  // follow each other without gaps, their parts one behind the other are the mesh of
  // Extractor::extract(), bit for bit. The result has the counts of the part and the seconds spent.
  virtual ExtractStats emit(const MeshSize& first, IndexedMesh& mesh) = 0;

  // If the CPU makes the part although a device was asked for: the reason. Else empty.
  std::string fallback{};
};

// Marching cubes over the bricks that the surface crosses. The mesh is closed, 2-manifold and
// oriented outwards for every input. Each crossed grid edge gives one vertex, so no vertices need
// to be welded afterwards. Index arrays and labels are the same for every backend and any number of
// threads.
class Extractor {
 public:
  virtual ~Extractor() = default;

  // Replaces `result` by the mesh of the spheres and reuses the memory of its arrays. Throws
  // InvalidInput for wrong options or no spheres, LimitExceeded for too many cells, vertices or
  // bytes, and Cancelled if the monitor asks to stop; `result` has no meaning then.
  virtual void extract_into(ExtractResult& result, const SphereSet& spheres,
                            const ExtractOptions& options) const = 0;

  // extract_into() a new result.
  ExtractResult extract(const SphereSet& spheres, const ExtractOptions& options) const {
    ExtractResult result;
    extract_into(result, spheres, options);
    return result;
  }

  // The first step of an extraction that several processes or devices share. Each of them counts a
  // range of bricks with this function, adds up the sizes of the ranges before its own, and makes
  // its part of the mesh with SurfacePart::emit(). The function also counts the bricks behind the
  // range, about a layer, because triangles at its border refer to them, and with half-edges as
  // many before it. So `spheres` must have all spheres near these bricks; it may lack the others if
  // all processes use the same GridOptions::given and, of a blended field, the same frame. Throws
  // as extract() does, but does not check the size of the mesh.
  virtual std::unique_ptr<SurfacePart> count(const SphereSet& spheres, const KeyRange& range,
                                             const ExtractOptions& options) const = 0;
};

// The CPU backend. It uses all cores through oneTBB.
std::unique_ptr<Extractor> make_cpu_extractor();

}  // namespace vdwmesh
