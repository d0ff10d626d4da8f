// Proven bounds of the distances between a mesh of any program and the solvent-excluded surface.
//
// Samples (excluded_distances.hpp) only tell that two surfaces are at least so far from each other.
// Here each of them is covered by cells: triangles of the mesh, and pieces of the patches. Of each
// cell a bound is known that no point of it exceeds. Cells whose bound is above the largest
// distance measured so far, by more than the gap, are divided, until there are none. The source
// proves the bounds.
#pragma once

#include <cstdint>

#include "core/errors.hpp"
#include "excluded/excluded_measures.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct DistanceBoundOptions {
  double gap = 0.05;  // the upper bound is at most this share above the lower one
  // After so many points of a direction no cell is divided any more: the bounds hold, but their gap
  // may be wider.
  std::uint64_t most_points = 30'000'000;
  std::uint64_t memory_limit = kNoMemoryLimit;  // bytes, with the mesh
  Monitor* monitor = nullptr;
};

// No point is farther than `upper`, and one is as far as `lower`, Å.
struct DistanceBounds {
  double lower = 0, upper = 0;
};

struct HausdorffBounds {
  DistanceBounds mesh_to_surface, surface_to_mesh;
  std::uint64_t points = 0;  // measured
  // Of the larger one of the two distances.
  double lower() const;
  double upper() const;
};

// The result is the same bit for bit for any number of threads. Throws as excluded_distances()
// does; a gap must be above 0.
HausdorffBounds excluded_distance_bounds(const IndexedMesh& mesh, const SphereSet& atoms,
                                         double probe, const DistanceBoundOptions& options = {},
                                         ExcludedPart part = ExcludedPart::complete);

}  // namespace vdwmesh
