// IndexedMesh -> finer IndexedMesh: midpoint subdivision, then Newton projection onto the surface.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "extract/field.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

class Monitor;
class Workspace;

// The surface that vertices are moved to: none, the isosurface F = T of a blended field (`field`),
// or the boundary of the union of the balls (`vdw`).
enum class Projection : std::uint8_t { none, field, vdw };

// The size of a closed mesh after `levels` midpoint subdivisions. Each adds one vertex per edge,
// and a closed mesh has 3/2 edges per triangle.
constexpr MeshSize subdivided(MeshSize mesh, int levels = 1) {
  for (int l = 0; l < levels; ++l) {
    mesh = {mesh.vertices + mesh.triangles * 3 / 2, 4 * mesh.triangles};
  }
  return mesh;
}

// What happens to moves of vertices after which two triangles cross: they stay, or are taken back.
enum class Crossings : std::uint8_t { allow, undo };

// Called with the mesh of each level: level 0 is the given mesh, before its vertices are projected;
// level l is the mesh after subdivision l and its projection. Normals are not computed yet, and
// opposite half-edges may be missing.
using LevelObserver = std::function<void(int level, const IndexedMesh& mesh)>;

struct RefineOptions {
  int subdivisions = 0;  // 0 projects the given vertices only
  Projection projection = Projection::vdw;
  Crossings crossings = Crossings::undo;
  FieldOptions field;  // for Projection::field
  GridSpec grid;  // the grid of the extraction, for Projection::field (thesis sub-grids use it)
  std::uint64_t memory_limit = kNoMemoryLimit;  // bytes, compared with refine_bytes()
  LevelObserver on_level;                       // may be empty
  const CellListFrame* frame = nullptr;  // for Projection::field, as in ExtractOptions; may be null
  Monitor* monitor = nullptr;
  Workspace* workspace = nullptr;  // keeps memory and cell list for later calls; may be null
  std::uint64_t device_memory = kNoMemoryLimit;  // bytes, for the CUDA backend
  // What the caller will not read of the refined mesh, and is therefore not made.
  Normals normals = Normals::gradients;  // none: the result has none
  // Triangles. A subdivided mesh of more has no `opposite`.
  std::uint64_t half_edges_up_to = std::numeric_limits<std::uint64_t>::max();
};

inline constexpr int kMaxSubdivisions = 16;           // 4^16 = 2^32 triangles from one
inline constexpr double kProjectionTolerance = 1e-9;  // Å; this near counts as on the surface
inline constexpr int kMaxProjectionSteps = 32;        // steps for one vertex

// The counts of one level. A level handles the given vertices (level 0) or the midpoints that it
// makes. If they are projected, each of them is in exactly one of the first four counts.
struct ProjectionStats {
  std::uint64_t projected = 0;     // vertices that reached the surface and were not put back
  std::uint64_t unconverged = 0;   // left where they were: no convergence in the allowed steps
  std::uint64_t out_of_reach = 0;  // left where they were: too far from the surface
  std::uint64_t undone = 0;        // moves taken back: a triangle turned, or two crossed
  std::uint64_t turned = 0;        // triangles that face against their atoms' normals in the end
  int iterations_max = 0;          // the most Newton steps of a vertex
  double residual_max = 0;         // Å, over the converged vertices
};

struct RefineResult {
  IndexedMesh mesh;
  std::vector<ProjectionStats> levels;  // [0]: the given vertices; [l]: after subdivision l
  double seconds = 0;                   // without the time of the observer
  std::string fallback;  // why the CPU did the work in place of a device; empty if it did not
};

// Bytes that refine() takes at its peak beyond its arguments: the mesh of the last level, its
// parent, and the arrays for projection and for the search for crossings. After a subdivision this
// is about twice the bytes of the mesh that it returns, without one some three times. If triangles
// name their spheres, nothing is searched, and it is 4/3 of these bytes.
std::uint64_t refine_bytes(std::uint64_t vertices, std::uint64_t triangles, std::uint64_t spheres,
                           int subdivisions, TriangleLabels labels = TriangleLabels::none);

class Refiner {
 public:
  virtual ~Refiner() = default;
  // `mesh` must be closed, oriented and welded; normals, labels and opposite half-edges may be
  // absent. A subdivision of a mesh with V vertices, E edges and F triangles has V + E vertices and
  // 4 F triangles. The vertices keep their indices, and the midpoints follow in the order of the
  // lower half-edges of their edges. Triangle t becomes 4t .. 4t + 3. The given vertices are
  // projected once, and each midpoint once, on the level that makes it. A vertex that is on the
  // surface already is not moved. The result has `opposite` if it was given or computed, its
  // entries fit 32 bits, and the options do not leave it out.
  //
  // A move of a vertex is bad if it turns a triangle of one atom against that atom's outward
  // normal, or if a triangle at the vertex crosses another one. Bad moves are taken back in passes
  // until none is left, so no self-intersection is added (measured: docs/refinement.md). With
  // Crossings::allow, moves that make triangles cross stay.
  //
  // A projected vertex is labelled with the sphere or spheres that it was projected to. A midpoint
  // that could not be projected is labelled with the atom of one end of its edge, the end whose
  // sphere is nearer by distance - radius. Normals are those of the surface; on a circle or corner,
  // the mean of the spheres' outward normals. Projection::none interpolates the given normals
  // instead; the result has none if none were given.
  //
  // A mesh with `triangle_spheres` (which needs vertex labels) is refined under constraints. The
  // given vertices stay exactly where they are. The midpoint of an edge between two triangles of
  // sphere i goes to that sphere, radially, and is labelled {i}. The midpoint of an edge between
  // triangles of spheres i and j goes to the nearest point of their circle and is labelled {i, j},
  // lower id first. Children have their parent's sphere. No move is taken back, since no midpoint
  // can go to a wrong sphere. An arc that bulges into its triangle past the opposite side folds the
  // triangle; the mesher must avoid this, and `turned` shows it, measuring each triangle against
  // its own sphere. `projected` counts the vertices within kProjectionTolerance of all their
  // spheres, `unconverged` the others. Such a mesh has no blended field: Projection::field throws
  // InvalidInput. Projection::none leaves the midpoints on their edges; the labels are the same.
  //
  // The result is the same, bit for bit, for any number of threads. Throws InvalidInput for bad
  // options or a mesh that is not closed, LimitExceeded before memory is taken, and Cancelled.
  RefineResult refine(const SphereSet& spheres, const IndexedMesh& mesh,
                      const RefineOptions& options) const;
  // The same, but takes over the arrays of `mesh` instead of copying them.
  virtual RefineResult refine(const SphereSet& spheres, IndexedMesh&& mesh,
                              const RefineOptions& options) const = 0;
};

// The CPU backend: all cores, through TBB.
std::unique_ptr<Refiner> make_cpu_refiner();

}  // namespace vdwmesh
