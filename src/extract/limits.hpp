// Checks of limits that run before memory is taken, on every backend.
#pragma once

#include <cstdint>

#include "extract/field.hpp"
#include "extract/sampled_field.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// What a counted mesh is about to need.
struct MeshDemand {
  MeshSize size;
  MeshArrays arrays;
  std::uint64_t scratch_bytes;  // memory that is held at the same time as the mesh
  double spacing;               // of the grid, Å
};

// Called when vertices and triangles are counted and the mesh has no memory yet. Throws
// LimitExceeded beyond kMaxVertices, kMaxHalfEdges (if half-edges are asked for) or `memory_limit`
// bytes. The message has the number needed, the number allowed and a spacing that fits.
void check_mesh_limits(const MeshDemand& demand, std::uint64_t memory_limit);

// Called before a field is sampled at every node. Throws InvalidInput for vdw, which has no node
// values, and LimitExceeded if the values take more than `memory_limit` bytes.
void check_sampling(const FieldModel& model, std::uint64_t memory_limit);

// Called before a field in memory is meshed. Throws InvalidInput if its grid has a spacing that is
// not positive, numbers that are not finite or negative cells, if its values are not one per node,
// or if its isovalue is not finite. Throws LimitExceeded beyond kMaxCellsPerAxis.
void check_sampled(const SampledField& field);

}  // namespace vdwmesh
