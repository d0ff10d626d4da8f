// The stages of an extraction on the device, each in its own file.
#pragma once

#include <cstdint>

#include "cuda/memory/device_structures.cuh"
#include "extract/bricks/brick_numbering.hpp"
#include "extract/bricks/case_table.hpp"
#include "extract/sampled_field.hpp"

namespace vdwmesh {

// Of each sphere of a list its centre from `origin` and its reach, Å, in single precision; the
// reach so much wider that it covers the rounding.
struct RoughSpheres {
  const float4* spheres;
  Vec3d origin;
};

// What every kernel about the field needs; passed by value.
struct FieldContext {
  CellListView list;
  FieldModel model;
  RoughSpheres rough;
};

// The list and the model, whose rough spheres it owns.
class DeviceField {
 public:
  DeviceField(const CellListView& list, const FieldModel& model, const Stream& stream);
  const FieldContext& context() const { return context_; }

 private:
  DeviceArray<float4> rough_;
  FieldContext context_;
};

// The case table in the memory of the current device, where it stays.
const CaseTable* case_table_on_device();

struct KeyList {
  DeviceArray<std::uint64_t> keys;
  std::uint64_t count = 0;
};

// Keys of the bricks of a range whose bounds admit surface, rising. Throws LimitExceeded beyond
// `most`.
KeyList candidate_bricks_on_device(const FieldContext& f, const KeyRange& range, std::uint64_t most,
                                   const Stream& stream);

// Of the bricks b with b % kCountParts alike, so that not all of them add to one address.
struct CountPart {
  unsigned long long clipped_cells, surface_bricks;
  std::uint32_t most_atoms;  // of a blended field, that reach one brick
};
inline constexpr unsigned kCountParts = 64;

// Nodes that the cells of a brick touch.
inline constexpr int kBrickValues = kBrickReach * kBrickReach * kBrickReach;

// Node signs and counts of the candidate bricks; of blended fields also the values at the nodes of
// bricks that hold surface, kBrickValues of each, x fastest.
struct BrickCounts {
  BrickSums* sums;   // per brick
  CountPart* parts;  // kCountParts of them, to begin with 0
};
void count_bricks_on_device(const FieldContext& f, const std::uint64_t* keys, std::uint64_t size,
                            ActiveBrick* bricks, float* values, const BrickCounts& counts,
                            const Stream& stream);

// In all.
struct BrickTotals {
  BrickSums sums;
  unsigned long long clipped_cells, surface_bricks;
  std::uint32_t most_atoms;
};

// What is noticed while vertices and triangles are made; begins as zeros.
struct DeviceEmissionTally {
  unsigned long long clamped;  // vertices
  // Neighbours that the surface reaches and the list of bricks lacks: the mesh is wrong then.
  unsigned long long missing_neighbours;
};

// What counting leaves behind.
struct DeviceCountedBricks {
  DeviceArray<ActiveBrick> bricks;
  DeviceArray<BrickSums> before;  // each brick, and in all
  BrickTotals totals{};

  BrickList list() const { return {bricks.data(), before.data(), bricks.size()}; }
};

// A run of bricks in the list of all.
struct BrickRange {
  std::uint64_t begin, end;
  std::uint64_t size() const { return end - begin; }
};

inline BrickList part_of(const BrickList& list, const BrickRange& range) {
  return {list.bricks + range.begin, list.before + range.begin, range.size()};
}

// Positions, normals and labels of the vertices of the bricks, at their numbers; adds the clamped
// ones to `clamped`. `values` as counted, of these bricks.
void emit_vertices_on_device(const FieldContext& f, const BrickList& bricks,
                             std::uint32_t most_atoms, const float* values,
                             const DeviceMeshView& mesh, unsigned long long* clamped,
                             const Stream& stream);
void emit_sampled_vertices_on_device(const SampledFieldView& field, const BrickList& bricks,
                                     const DeviceMeshView& mesh, unsigned long long* clamped,
                                     const Stream& stream);

// Places in the list of the neighbours that the triangles of a brick touch: the seven at an upper
// side, at dx + 2 dy + 4 dz - 1, and the three across a lower face, at 7 + axis. kNoBrick where a
// neighbour is not in the list.
inline constexpr int kTriangleNeighbours = 10;
inline constexpr std::uint32_t kNoBrick = ~std::uint32_t{0};
struct TriangleNeighbours {
  std::uint32_t place[kTriangleNeighbours];
};

// The neighbours of every brick. Throws LimitExceeded for more bricks than 32 bits number.
DeviceArray<TriangleNeighbours> find_triangle_neighbours(const KeyList& keys, const Stream& stream);

// Corners of the triangles of the bricks of a range, at their numbers, and where `mesh` has room
// for them the opposite half-edges; `bricks` and `neighbours` are those of the whole list. Adds the
// neighbours that are missing to the tally.
void emit_triangles_on_device(const BrickList& bricks,
                              const DeviceArray<TriangleNeighbours>& neighbours,
                              const BrickRange& range, const DeviceMeshView& mesh,
                              DeviceEmissionTally* tally, const Stream& stream);

// What an extraction keeps of every candidate brick beside the mesh and the field: its key, signs
// and counts, two sums, neighbours.
inline constexpr std::uint64_t kBrickBytes = sizeof(std::uint64_t) + sizeof(ActiveBrick) +
                                             2 * sizeof(BrickSums) + sizeof(TriangleNeighbours);

}  // namespace vdwmesh
