// Checks of limits that run before memory is allocated, on every backend.
#pragma once

#include <cstdint>

#include "extract/field.hpp"
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

// The field of the options on its grid, checked for sampling, as FieldMesher::sample() begins on
// every backend: fills the grid and the isovalue of `field` and leaves its values to the caller.
// Throws InvalidInput for vdw, which has no values, and LimitExceeded if the values take more than
// options.memory_limit bytes.
FieldModel begin_sampling(SampledField& field, const SphereSet& spheres,
                          const ExtractOptions& options);

// Called before a field in memory is meshed. Throws InvalidInput if its grid has a spacing that is
// not positive, numbers that are not finite or negative cells, or if its isovalue is not finite.
// Throws LimitExceeded beyond kMaxCellsPerAxis.
void check_sampled(const SampledFieldView& field);
// The same of a field that owns its values, which must be one for each node.
void check_values(const SampledField& field);

}  // namespace vdwmesh
