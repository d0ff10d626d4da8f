// Limits that are checked before memory is taken.
#pragma once

#include <cstdint>

#include "extract/field.hpp"
#include "extract/sampled_field.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// What a mesh of marching cubes is about to need.
struct MeshDemand {
  MeshSize size;
  MeshArrays arrays;
  std::uint64_t scratch_bytes;  // held beside the mesh
  double spacing;               // Å
};

// Throws LimitExceeded beyond kMaxVertices, kMaxHalfEdges or `memory_limit` bytes; the message has
// the number needed, the number there and a spacing that fits.
void check_mesh_limits(const MeshDemand& demand, std::uint64_t memory_limit);

// Before a field is sampled at every node: throws InvalidInput for vdw, which has no values, and
// LimitExceeded where they take more than `memory_limit` bytes.
void check_sampling(const FieldModel& model, std::uint64_t memory_limit);

// Before a field in memory is meshed: throws InvalidInput where its grid is none or its values are
// not one per node, LimitExceeded beyond kMaxCellsPerAxis.
void check_sampled(const SampledField& field);

}  // namespace vdwmesh
