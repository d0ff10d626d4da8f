// What the kernel that writes triangles (emit_triangles.cu) keeps in shared memory: the tables of
// the cases, which all groups of a thread block read, and what each group has of its brick. A group
// is two warps, which work on one brick at a time and wait for each other at a barrier of their
// own.
#pragma once

#include "cuda/extract/brick_warp.cuh"
#include "cuda/extract/extract_stages.cuh"
#include "cuda/extract/triangle_codes.cuh"
#include "cuda/extract/triangle_neighbours.cuh"

namespace vdwmesh {

inline constexpr unsigned kTriangleThreads = 2 * kWarp;  // of a group
// The most groups of a thread block, and the thread blocks that a multiprocessor gets. They leave a
// third of its registers and 50 KB of its shared memory to the vertices, which are made meanwhile.
inline constexpr unsigned kGroups = 8, kBlocksPerProcessor = 2;
static_assert(kGroups < 16, "barriers are numbered to 15, and one is the whole block's");

__device__ inline unsigned own_group() { return threadIdx.x / kTriangleThreads; }
__device__ inline unsigned own_thread() { return threadIdx.x % kTriangleThreads; }
__device__ inline unsigned own_half() { return threadIdx.x / kWarp % 2; }  // the warp of the group

// Waits until all threads of the group are there, as __syncthreads() does for a block.
__device__ inline void sync_group() {
  asm volatile("bar.sync %0, %1;" ::"r"(own_group() + 1), "n"(kTriangleThreads) : "memory");
}

// Words of 32 bits for a bit of each triangle that a brick can have.
inline constexpr unsigned kTriangleWords = kMaxCaseTriangles * kBrickNodes / kWarp;
inline constexpr int kCellsPerFace = kBrickSide * kBrickSide;

// A row of eight nodes along x: from these two the number of each of its vertices follows
// (corner_number()).
struct alignas(8) VertexRow {
  std::uint32_t first;  // number in the mesh of the first vertex of the row
  // RowCrossings::packed: bit 8 * axis + x says whether node x's edge along the axis is crossed.
  std::uint32_t crossed;
};

// A cell of the brick that the surface crosses, in one word. Cells are numbered 64 z + 8 y + x.
struct MixedCell {
  std::uint32_t bits;

  __device__ unsigned cell() const { return bits & 511u; }
  __device__ std::uint32_t inside() const { return bits >> 9 & 255u; }  // its case
  __device__ std::uint32_t start() const { return bits >> 17; }  // triangles in the cells before it
};
__device__ inline MixedCell mixed_cell(unsigned cell, std::uint32_t inside, std::uint32_t start) {
  return {cell | inside << 9 | start << 17};
}

// A mixed cell of the shell in one word: the number of its first half-edge in its brick, its case,
// and which brick that is: 0 is the group's own, 1 + f the one beyond face f. Whatever stands in a
// cell that is not set, brick() is at most 7.
struct ShellCell {
  std::uint32_t bits;

  __device__ std::uint32_t half_edge() const { return bits & 8191u; }
  __device__ std::uint32_t inside() const { return bits >> 16 & 255u; }
  __device__ std::uint32_t brick() const { return bits >> 29; }
};
static_assert(3 * kMaxCaseTriangles * kBrickNodes < 8192);
__device__ inline ShellCell shell_word(std::uint32_t inside, std::uint32_t half_edge,
                                       std::uint32_t brick) {
  return {half_edge | inside << 16 | brick << 29};
}

// For half-edges: the mixed cells of the brick and of the layers beyond its faces, by shell_cell().
// Entries of other cells are not set; if a neighbour is missing, those beyond its face are read all
// the same, and check_neighbours() in emit_triangles.cu reports it.
template <Connectivity>
struct Shell {};
template <>
struct Shell<Connectivity::half_edges> {
  ShellCell cell[kShellCells];
  // By ShellCell::brick(): the number in the mesh of the brick's first half-edge.
  std::uint32_t first_half_edge[8];
};

// Shared memory of a group: 9 KB with half-edges, else 5 KB.
template <Connectivity connectivity>
struct TriangleShared {
  ActiveBrick brick;
  TriangleNeighbours near;
  // rows[9 z + y] has the nodes x = 0 .. 7 of row (y, z), with y and z = 0 .. 8. The next 81
  // entries are the same rows in the next brick along x; of these only the first nodes are used,
  // which are this brick's nodes x = 8. Rows at a face are set only if the surface crosses the
  // face.
  VertexRow rows[2 * kRows];
  MixedCell cells[kBrickNodes];  // in the order of their triangles
  // Bit t % 32 of word t / 32 is set if triangle t is the first one of a cell. There are three more
  // words: the last word of a brick may be partly filled, a warp reads one word ahead, and one word
  // is to spare.
  std::uint32_t begins[kTriangleWords + 3];
  std::uint32_t face_signs;            // see share_face_signs()
  std::uint32_t staged[2][3 * kWarp];  // of each warp, see store_staged()
  Shell<connectivity> shell;
};

// Shared memory of a thread block.
template <Connectivity connectivity>
struct TriangleBlock {
  TriangleCodes codes;
  TriangleShared<connectivity> group[kGroups];
};

// Copies the tables to shared memory. By a thread block; the caller synchronises afterwards.
__device__ inline void share_codes(const TriangleCodes& from, TriangleCodes& to) {
  static_assert(sizeof(TriangleCodes) % sizeof(uint4) == 0);
  const auto* const source = reinterpret_cast<const uint4*>(&from);
  auto* const target = reinterpret_cast<uint4*>(&to);
  for (unsigned w = threadIdx.x; w < sizeof(TriangleCodes) / sizeof(uint4); w += blockDim.x) {
    target[w] = source[w];
  }
}

// What a thread loads of a brick: a word of 8 bytes of it, and a neighbour. Both go to registers
// first, so that these loads are under way together with those that tell whether the brick has
// triangles (load_now()). share() then writes them to shared memory.
struct LoadedBrick {
  static constexpr unsigned kWords = sizeof(ActiveBrick) / sizeof(std::uint64_t);
  static_assert(kWords <= kTriangleThreads && sizeof(ActiveBrick) % sizeof(std::uint64_t) == 0);

  std::uint64_t word;
  std::uint32_t neighbour;
  BrickSums before;
  std::uint64_t after;  // how many triangles there are before the next brick

  // Threads beyond the end repeat the last word or neighbour.
  __device__ LoadedBrick(const BrickList& list, const TriangleNeighbours* neighbours,
                         std::uint32_t own)
      : word(reinterpret_cast<const std::uint64_t*>(
            list.bricks + own)[own_thread() < kWords ? own_thread() : kWords - 1]),
        neighbour(
            neighbours[own].place[own_thread() < kTriangleNeighbours ? own_thread()
                                                                     : kTriangleNeighbours - 1]),
        before(list.before[own]),
        after(list.before[own + 1].triangles) {
    load_now(word);
    load_now(neighbour);
  }
  // The caller synchronises afterwards.
  __device__ void share(ActiveBrick& brick, TriangleNeighbours& near) const {
    if (own_thread() < kWords) reinterpret_cast<std::uint64_t*>(&brick)[own_thread()] = word;
    if (own_thread() < kTriangleNeighbours) near.place[own_thread()] = neighbour;
  }
};

}  // namespace vdwmesh
