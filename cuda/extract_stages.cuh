// The stages of an extraction on the device, each in its own file.
#pragma once

#include <cstdint>

#include "cuda/device_structures.cuh"
#include "extract/brick_numbering.hpp"
#include "extract/case_table.hpp"

namespace vdwmesh {

// What every kernel about the field needs; passed by value.
struct FieldContext {
  CellListView list;
  FieldModel model;
};

struct KeyList {
  DeviceArray<std::uint64_t> keys;
  std::uint64_t count = 0;
};

// Keys of the bricks whose bounds admit surface, rising. Throws LimitExceeded beyond `most`.
KeyList candidate_bricks_on_device(const FieldContext& f, std::uint64_t most, const Stream& stream);

// Node signs and counts of the candidate bricks.
struct BrickCounts {
  std::uint64_t* vertices;             // per brick
  std::uint64_t* triangles;            // per brick
  unsigned long long* clipped_cells;   // in all
  unsigned long long* surface_bricks;  // in all
};
void count_bricks_on_device(const FieldContext& f, const KeyList& candidates,
                            const CaseTable* table, ActiveBrick* bricks, const BrickCounts& counts,
                            const Stream& stream);

// Positions, normals and labels; adds the clamped vertices to `clamped`.
void emit_vertices_on_device(const FieldContext& f, const BrickList& bricks,
                             const DeviceMeshView& mesh, unsigned long long* clamped,
                             const Stream& stream);

// Corners and opposite half-edges.
void emit_triangles_on_device(const BrickList& bricks, const CaseTable* table,
                              const DeviceMeshView& mesh, const Stream& stream);

}  // namespace vdwmesh
