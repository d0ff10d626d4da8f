// IndexedMesh -> finer IndexedMesh: midpoint subdivision, then Newton projection onto the surface.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/monitor.hpp"
#include "extract/extractor.hpp"
#include "extract/field.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// The surface that vertices are moved to: none; the blended isosurface F = T; the boundary of the
// union of the balls.
enum class Projection : std::uint8_t { none, field, vdw };

// Of a closed mesh after so many midpoint subdivisions.
constexpr MeshSize subdivided(MeshSize mesh, int levels = 1) {
  for (int l = 0; l < levels; ++l) {
    mesh = {mesh.vertices + mesh.triangles * 3 / 2, 4 * mesh.triangles};
  }
  return mesh;
}

enum class Crossings : std::uint8_t { allow, undo };

// Sees the mesh as it goes: level 0 is the given one, level l the one after subdivision l and its
// projection. Normals are not computed yet, and half-edges may be missing.
using LevelObserver = std::function<void(int level, const IndexedMesh& mesh)>;

struct RefineOptions {
  int subdivisions = 0;  // 0 projects the given vertices only
  Projection projection = Projection::vdw;
  Crossings crossings = Crossings::undo;  // whether moves that make triangles cross are taken back
  FieldOptions field;                     // for Projection::field
  GridSpec grid;                          // of the extraction (thesis sub-grids refer to it)
  std::uint64_t memory_limit = kNoMemoryLimit;  // bytes, compared with refine_bytes()
  LevelObserver on_level;                       // may be empty
  const CellListFrame* frame = nullptr;  // for Projection::field, as in ExtractOptions; may be null
  Monitor* monitor = nullptr;
  Workspace* workspace = nullptr;  // may be null; else keeps memory and cell list for later calls
  std::uint64_t device_memory = kNoMemoryLimit;  // bytes, for the CUDA backend
};

inline constexpr int kMaxSubdivisions = 16;           // 4^16 = 2^32 triangles from one
inline constexpr double kProjectionTolerance = 1e-9;  // Å, distance to the surface when converged
inline constexpr int kMaxProjectionSteps = 32;

// Every vertex that a level handles is in exactly one of the first four counts.
struct ProjectionStats {
  std::uint64_t projected = 0;     // vertices that converged and stayed there
  std::uint64_t unconverged = 0;   // left where they were: no convergence in the allowed steps
  std::uint64_t out_of_reach = 0;  // left where they were: too far from the surface
  std::uint64_t undone = 0;        // moves taken back: a triangle turned, or two crossed
  std::uint64_t turned = 0;        // triangles that still face against their atoms' normals
  int iterations_max = 0;
  double residual_max = 0;  // Å, over the converged vertices
};

struct RefineResult {
  IndexedMesh mesh;
  std::vector<ProjectionStats> levels;  // [0]: the given vertices; [l]: after subdivision l
  double seconds = 0;                   // without those of the observer
  std::string fallback;  // why the CPU did what a device was to do; empty: it did not
};

// Bytes that refine() takes at its peak beyond its arguments: the last level's mesh, the one it
// comes from, and what finds the triangles that cross. About twice the bytes of the mesh that it
// returns; where triangles name their spheres, so that nothing is looked for, 4/3 of them.
std::uint64_t refine_bytes(std::uint64_t vertices, std::uint64_t triangles, std::uint64_t spheres,
                           int subdivisions, TriangleLabels labels = TriangleLabels::none);

class Refiner {
 public:
  virtual ~Refiner() = default;
  // `mesh` is closed, oriented and welded; normals, labels and opposite half-edges may be absent.
  // Each level has V + E vertices and 4 F triangles; the vertices of a level keep their indices,
  // midpoints follow in the order of their edges (by first half-edge), triangle t becomes
  // 4t .. 4t + 3. The given vertices are projected once, midpoints once on the level that makes
  // them; what is on the surface already is not touched. The result has `opposite` where it was
  // given or computed and its entries fit 32 bits.
  //
  // Moves that turn a triangle of one atom against that atom's outward normal, or that are of
  // triangles that cross, are taken back in simultaneous passes until there are none, so that no
  // self-intersection is added (measured: docs/refinement.md). Crossings::allow leaves the latter.
  //
  // Labels: of the surface that a vertex was projected to. A midpoint that could not be projected
  // takes the atom of that end which is nearer by distance - radius.
  // Normals: of that surface; on a circle or corner the mean of the spheres' outward normals.
  // Projection::none interpolates the given normals instead, and leaves them out if they are.
  //
  // A mesh with `triangle_spheres` (which needs vertex labels) is refined under constraints: the
  // given vertices stay exactly where they are; the midpoint of an edge between triangles of one
  // sphere goes to that sphere, radially, and is labelled {i}; that of an edge between triangles of
  // two spheres goes to the nearest point of their circle and is labelled {i, j}, lower id first.
  // Children are of their parent's sphere. No move is taken back, none being wrong by itself: an
  // arc that bulges into its triangle past the opposite side is for the mesher to avoid, and shows
  // in `turned`, where each triangle is measured against its own sphere. `projected` counts the
  // vertices within kProjectionTolerance of all their spheres, `unconverged` the others. Such a
  // mesh has no blended field: Projection::field throws InvalidInput. Projection::none leaves the
  // midpoints on their edges; the labels are the same.
  //
  // The result is the same, bit for bit, for any number of threads. Throws InvalidInput (options,
  // a mesh that is not closed), LimitExceeded before memory is taken, Cancelled.
  RefineResult refine(const SphereSet& spheres, const IndexedMesh& mesh,
                      const RefineOptions& options) const;
  // The same without a copy of the arrays, for a mesh that is not needed any more.
  virtual RefineResult refine(const SphereSet& spheres, IndexedMesh&& mesh,
                              const RefineOptions& options) const = 0;
};

// The CPU backend: all cores, through TBB.
std::unique_ptr<Refiner> make_cpu_refiner();

}  // namespace vdwmesh
