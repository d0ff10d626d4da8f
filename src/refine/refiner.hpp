// IndexedMesh -> finer IndexedMesh: midpoint subdivision, then Newton projection onto the surface.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/monitor.hpp"
#include "extract/extractor.hpp"
#include "extract/field.hpp"
#include "extract/indexed_mesh.hpp"

namespace vdwmesh {

// The surface that vertices are moved to: none; the blended isosurface F = T; the boundary of the
// union of the balls.
enum class Projection : std::uint8_t { none, field, vdw };

struct RefineOptions {
  int subdivisions = 0;                         // 0 projects the given vertices only
  Projection projection = Projection::vdw;
  FieldOptions field;                           // for Projection::field
  GridSpec grid;                                // of the extraction (thesis sub-grids refer to it)
  std::uint64_t memory_limit = kNoMemoryLimit;  // bytes
  Monitor* monitor = nullptr;
};

inline constexpr double kProjectionTolerance = 1e-9;  // Å, distance to the surface when converged
inline constexpr int kMaxProjectionSteps = 32;

struct ProjectionStats {
  std::uint64_t projected = 0;      // vertices that converged
  std::uint64_t unconverged = 0;    // left where they were: no convergence in the allowed steps
  std::uint64_t out_of_reach = 0;   // left where they were: too far from the surface
  std::uint64_t undone = 0;         // moves taken back because they turned a triangle
  std::uint64_t turned = 0;         // triangles that still face against their atoms' normals
  int iterations_max = 0;
  double residual_max = 0;          // Å, over the converged vertices
};

struct RefineResult {
  IndexedMesh mesh;
  std::vector<ProjectionStats> levels;  // [0]: the given vertices; [l]: after subdivision l
  double seconds = 0;
};

class Refiner {
 public:
  virtual ~Refiner() = default;
  // `mesh` is closed, oriented and welded. Each level has V + E vertices and 4 F triangles; the
  // vertices of a level keep their indices, midpoints follow in the order of their edges (by first
  // half-edge), triangle t becomes 4t .. 4t + 3. Throws InvalidInput, LimitExceeded before memory
  // is taken, Cancelled.
  virtual RefineResult refine(const SphereSet& spheres, const IndexedMesh& mesh,
                              const RefineOptions& options) const = 0;
};

std::unique_ptr<Refiner> make_cpu_refiner();

}  // namespace vdwmesh
