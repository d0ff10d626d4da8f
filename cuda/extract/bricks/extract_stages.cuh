// The stages of an extraction on the device, each in a file of its own: device_field.cu,
// brick_search.cu, count_bricks.cu, emit_vertices.cu and emit_triangles.cu; case_tables.cu has what
// they look up. DeviceBrickMesher (brick_mesher.cuh) runs them. All pointers lead to device memory.
#pragma once

#include <cstdint>

#include "cuda/extract/bricks/triangle_neighbours.cuh"
#include "cuda/extract/fields.cuh"
#include "cuda/memory/device_structures.cuh"
#include "extract/bricks/brick_numbering.hpp"
#include "extract/bricks/case_table.hpp"
#include "extract/sampled_field.hpp"

namespace vdwmesh {

// The marching cubes cases, and the codes of their half-edges (triangle_codes.cuh), in the memory
// of the current device, where they stay.
struct TriangleCodes;
const CaseTable* case_table_on_device();
const TriangleCodes* triangle_codes_on_device();

// Keys, rising, of the candidate bricks: those of a range whose bounds admit surface. Throws
// LimitExceeded if they are more than `most`.
KeyList candidate_bricks_on_device(const OneField& fields, const KeyRange& range,
                                   std::uint64_t most, const Stream& stream);
KeyList candidate_bricks_on_device(const FieldStack& fields, const KeyRange& range,
                                   std::uint64_t most, const Stream& stream);

// Counts over the bricks i with one value of i % kCountParts, so that not all add to one address.
struct CountPart {
  unsigned long long clipped_cells, surface_bricks;
  std::uint32_t most_atoms;  // the most atoms that reach one brick; for blended fields only
};
inline constexpr unsigned kCountParts = 64;

// Where counting writes, beside the bricks themselves.
struct BrickCounts {
  BrickSums* sums;   // of each brick
  CountPart* parts;  // kCountParts of them; zeros before the counting
};
// Computes the node signs and counts of the `size` bricks with these keys, and writes them to
// `bricks` and `counts`. `kept`: a KeptUnion or a KeptBlended (kept_bricks.cuh) of each brick.
void count_bricks_on_device(const OneField& fields, const std::uint64_t* keys, std::uint64_t size,
                            ActiveBrick* bricks, void* kept, const BrickCounts& counts,
                            const Stream& stream);
void count_bricks_on_device(const FieldStack& fields, const std::uint64_t* keys, std::uint64_t size,
                            ActiveBrick* bricks, void* kept, const BrickCounts& counts,
                            const Stream& stream);

// The sums over all bricks; of most_atoms the maximum.
struct BrickTotals {
  BrickSums sums;
  unsigned long long clipped_cells, surface_bricks;
  std::uint32_t most_atoms;
};

// Counts made while vertices and triangles are written; they begin as zeros.
struct DeviceEmissionTally {
  unsigned long long clamped;  // clamped vertices
  // How often the surface goes on in a brick that the list lacks: the mesh is wrong unless it is 0.
  unsigned long long missing_neighbours;
};

// The result of counting: all candidate bricks, and their numbering.
struct DeviceCountedBricks {
  DeviceArray<ActiveBrick> bricks;
  DeviceArray<BrickSums> before;  // as in BrickList
  BrickTotals totals{};

  BrickList list() const { return {bricks.data(), before.data(), bricks.size()}; }
};

// A run of bricks, as indices begin .. end - 1 into the list of all bricks.
struct BrickRange {
  std::uint64_t begin, end;
  std::uint64_t size() const { return end - begin; }
};

// The bricks of a run as a list; they keep their numbers in the mesh.
inline BrickList part_of(const BrickList& list, const BrickRange& range) {
  return {list.bricks + range.begin, list.before + range.begin, range.size()};
}

// Writes the vertices of `bricks` to the arrays of `mesh`, each at the index of its number, and
// adds the number of clamped ones to `clamped`. `kept` is what counting has kept of these bricks,
// and most_atoms is at least the number of atoms near any of them. The last function does the same
// for a field that is given by its values at the nodes.
void emit_vertices_on_device(const OneField& fields, const BrickList& bricks,
                             std::uint32_t most_atoms, const void* kept, const DeviceMeshView& mesh,
                             unsigned long long* clamped, const Stream& stream);
void emit_vertices_on_device(const FieldStack& fields, const BrickList& bricks,
                             std::uint32_t most_atoms, const void* kept, const DeviceMeshView& mesh,
                             unsigned long long* clamped, const Stream& stream);
void emit_sampled_vertices_on_device(const SampledFieldView& field, const BrickList& bricks,
                                     const DeviceMeshView& mesh, unsigned long long* clamped,
                                     const Stream& stream);

// Writes the corners of the triangles of the bricks in `range` to the arrays of `mesh`, at the
// indices of their numbers, and the opposite half-edges too if `mesh` has an array for them.
// `bricks` and `neighbours` are of the whole list, not only of the range. Adds missing neighbours
// to the tally, but not those with keys below `searched_from`. `before_mesh`: null, or for a stack,
// by layer of bricks, what the meshes of the fields before that of the layer have; then each mesh
// is numbered from 0.
void emit_triangles_on_device(const BrickList& bricks,
                              const DeviceArray<TriangleNeighbours>& neighbours,
                              std::uint64_t searched_from, const BrickSums* before_mesh,
                              const BrickRange& range, const DeviceMeshView& mesh,
                              DeviceEmissionTally* tally, const Stream& stream);

// Bytes that an extraction keeps of every candidate brick, beside the mesh and the field.
inline constexpr std::uint64_t kBrickBytes = sizeof(std::uint64_t) + sizeof(ActiveBrick) +
                                             2 * sizeof(BrickSums) + sizeof(TriangleNeighbours);

}  // namespace vdwmesh
