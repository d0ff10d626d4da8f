// Checks of limits that run before memory is allocated, on every backend.
#pragma once

#include <cstdint>

#include "extract/sampled_field.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// The size of a mesh that has been counted but not yet made, and the memory around it.
struct MeshDemand {
  MeshSize size;
  MeshArrays arrays;
  std::uint64_t scratch_bytes;  // memory that is held at the same time as the mesh
  double spacing;               // of the grid, Å
};

// Called after vertices and triangles have been counted and before the mesh is allocated. Throws
// LimitExceeded for more than kMaxVertices vertices, for more than kMaxHalfEdges half-edges if
// these are wanted, or if mesh and scratch take more than `memory_limit` bytes. The message has the
// number needed, the number allowed and a spacing that fits.
void check_mesh_limits(const MeshDemand& demand, std::uint64_t memory_limit);

// Called before a field in memory is meshed. Throws InvalidInput if its grid has a spacing that is
// not positive, numbers that are not finite or negative cells, or if its isovalue is not finite.
// Throws LimitExceeded beyond kMaxCellsPerAxis.
void check_sampled(const SampledFieldView& field);

}  // namespace vdwmesh
