// What the kernel that writes triangles (emit_triangles.cu) keeps in shared memory: the tables of
// the cases, which all groups of a thread block read, and what each group has of its brick. A group
// is two warps, which work on one brick at a time and wait for each other at a barrier of their
// own. Here the group gathers what the brick itself knows: its mixed cells, the rows of nodes that
// it owns, and the faces that the surface crosses. What lies beyond these faces comes from its
// neighbours.
#pragma once

#include "cuda/extract/bricks/brick_warp.cuh"
#include "cuda/extract/bricks/extract_stages.cuh"
#include "cuda/extract/bricks/triangle_codes.cuh"
#include "cuda/extract/bricks/triangle_neighbours.cuh"

namespace vdwmesh {

inline constexpr unsigned kGroupThreads = 2 * kWarp;
// The most groups of a thread block, and the thread blocks for which a multiprocessor of compute
// capability 9.0 has room; on one of 8.0 only one fits with half-edges. On 9.0 they leave a third
// of its registers and 50 KB of its shared memory to the vertices, which are made meanwhile.
inline constexpr unsigned kMostGroups = 8, kBlocksPerProcessor = 2;
static_assert(kMostGroups < 16, "barriers are numbered to 15, and one is the whole block's");

__device__ inline unsigned own_group() { return threadIdx.x / kGroupThreads; }
__device__ inline unsigned own_thread() { return threadIdx.x % kGroupThreads; }
__device__ inline unsigned own_half() { return threadIdx.x / kWarp % 2; }  // the warp of the group

// Waits until all threads of the group are there, as __syncthreads() does for a block.
__device__ inline void sync_group() {
  asm volatile("bar.sync %0, %1;" ::"r"(own_group() + 1), "n"(kGroupThreads) : "memory");
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
struct CellShell {};
template <>
struct CellShell<Connectivity::half_edges> {
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
  CellShell<connectivity> shell;
};

// Shared memory of a thread block.
template <Connectivity connectivity>
struct TriangleBlock {
  TriangleCodes codes;
  TriangleShared<connectivity> group[kMostGroups];
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

// ---- the brick's own cells and rows ----

// What a thread loads of a brick: a word of 8 bytes of it, a neighbour, and what stands before the
// brick and before the next one. Word and neighbour go to registers first, so that these loads are
// under way together with those that tell whether the brick has triangles (load_now()). share()
// then writes them to shared memory.
struct LoadedBrick {
  static constexpr unsigned kWords = sizeof(ActiveBrick) / sizeof(std::uint64_t);
  static_assert(kWords <= kGroupThreads && sizeof(ActiveBrick) % sizeof(std::uint64_t) == 0);

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

// Fills `cells`, `begins` and the brick's part of `shell`. Each warp has half of the 64 rows of
// cells: first a lane for each row lists the row's mixed cells, then a lane for each mixed cell
// finds its case, and prefix sums over the cells give the numbers of their triangles.
template <Connectivity connectivity>
__device__ void share_cells(const TriangleCodes& codes, TriangleShared<connectivity>& s) {
  const unsigned lane = threadIdx.x % kWarp, half = own_half();
  const unsigned row = own_thread();
  const int y = static_cast<int>(row) % kBrickSide, z = static_cast<int>(row) / kBrickSide;
  const std::uint32_t mixed = mixed_cells(s.brick.signs, y, z);
  const auto own = static_cast<std::uint32_t>(__popc(mixed)), sum = warp_inclusive_sum(own);
  const std::uint32_t count = __shfl_sync(kAllLanes, sum, kWarp - 1);
  std::uint32_t base = 0, start = 0;  // of the half: its first entry of `cells`, its first triangle
  if (half == 1) {
    constexpr int half_height = kBrickSide / 2;
    const auto lower =
        static_cast<unsigned>(__popc(mixed_cells(s.brick.signs, y, z - half_height)));
    base = __reduce_add_sync(kAllLanes, lower);
    // The second half begins with row kWarp.
    start = s.brick.row_triangles[kWarp];
  }
  // `cells &= cells - 1` removes the lowest bit.
  std::uint32_t next = base + sum - own;
  for (std::uint32_t cells = mixed; cells != 0; cells &= cells - 1) {
    s.cells[next++].bits =
        row * kBrickSide + static_cast<unsigned>(__ffs(static_cast<int>(cells))) - 1;
  }
  __syncwarp();
  for (std::uint32_t first = 0; first < count; first += kWarp) {
    const std::uint32_t at = base + first + lane;
    const bool valid = first + lane < count;
    const unsigned cell = valid ? s.cells[at].bits : 0;
    const auto x = static_cast<int>(cell % kBrickSide),
               cell_y = static_cast<int>(cell / kBrickSide % kBrickSide);
    const auto cell_z = static_cast<int>(cell / kCellsPerFace);
    const std::uint32_t inside = cell_case(s.brick.signs, x, cell_y, cell_z);
    const std::uint32_t triangles = valid ? codes.count[inside] : 0;
    const std::uint32_t end = start + warp_inclusive_sum(triangles);
    start = __shfl_sync(kAllLanes, end, kWarp - 1);
    if (!valid) continue;
    const std::uint32_t own_start = end - triangles;
    s.cells[at] = mixed_cell(cell, inside, own_start);
    atomicOr(&s.begins[own_start / kWarp], 1u << own_start % kWarp);
    if constexpr (connectivity == Connectivity::half_edges) {
      s.shell.cell[shell_cell(x, cell_y, cell_z)] = shell_word(inside, 3 * own_start, 0);
    }
  }
}

// Fills the rows that the brick owns, a thread for each. `first` is the number of the brick's first
// vertex.
template <Connectivity connectivity>
__device__ void share_own_rows(std::uint64_t first, TriangleShared<connectivity>& s) {
  const auto y = static_cast<int>(own_thread()) % kBrickSide,
             z = static_cast<int>(own_thread()) / kBrickSide;
  s.rows[z * kBrickReach + y] = {
      static_cast<std::uint32_t>(first + s.brick.row_vertices[own_thread()]),
      row_crossings(s.brick.signs, y, z).packed};
}

// What a row of nodes adds to `face_signs`. Bit x = 0 .. 8: some node of the layer x is inside; the
// layers 0 and 8 are faces. Bits 9, 10, 11 and 12: some node of the face y = 0, y = 8, z = 0 or
// z = 8 is inside; `layers` has the bits of those faces in which the row lies. The same bits plus
// 16: some node is outside.
__device__ inline std::uint32_t signs_of_row(std::uint32_t inside, std::uint32_t layers) {
  constexpr std::uint32_t all = (1u << kBrickReach) - 1;
  const std::uint32_t outside = ~inside & all;
  return inside | outside << 16 | (inside != 0 ? layers : 0) | (outside != 0 ? layers << 16 : 0);
}

// Adds all rows to `face_signs`. Each thread adds one row that the brick owns. The first nine also
// add two each of the 17 others, whose y or z is 8; the row with both is added twice, which
// changes nothing.
template <Connectivity connectivity>
__device__ void share_face_signs(TriangleShared<connectivity>& s) {
  constexpr std::uint32_t front = 1u << 9, back = 1u << 10, bottom = 1u << 11, top = 1u << 12;
  const unsigned y = own_thread() % kBrickSide, z = own_thread() / kBrickSide;
  std::uint32_t found =
      signs_of_row(s.brick.signs.row[z][y], (y == 0 ? front : 0) | (z == 0 ? bottom : 0));
  if (own_thread() < kBrickReach) {
    const unsigned i = own_thread();
    const std::uint32_t first = i == 0 ? 1u : 0u, last = i == kBrickSide ? 1u : 0u;
    found |= signs_of_row(s.brick.signs.row[i][kBrickSide], back | first * bottom | last * top);
    found |= signs_of_row(s.brick.signs.row[kBrickSide][i], top | first * front | last * back);
  }
  found = __reduce_or_sync(kAllLanes, found);
  if (threadIdx.x % kWarp == 0) atomicOr(&s.face_signs, found);
}

// Bit f is set if the surface crosses face f: some of its 9 x 9 nodes are inside, and some outside.
__device__ inline std::uint32_t faces_crossed(std::uint32_t face_signs) {
  const std::uint32_t mixed = face_signs & face_signs >> 16;
  return (mixed & 1u) | (mixed >> (kBrickSide - 1) & 2u) | (mixed >> 9 & 15u) << 2;
}

}  // namespace vdwmesh
