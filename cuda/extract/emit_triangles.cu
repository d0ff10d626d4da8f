// Writes the triangles of the bricks, and on request their opposite half-edges, with one thread
// block per brick. It is the device counterpart of TriangleEmitter; the numbers are the same.
// 1. find_neighbours finds each brick's neighbours in the list, once for all bricks.
// 2. emit_triangles gathers in shared memory all that is needed to compute the numbers of a brick's
//    vertices and half-edges: first vertices and crossed edges of its 9 x 9 rows of nodes, its
//    mixed cells (which the surface crosses) with their first triangles, and, for half-edges, the
//    mixed cells just beyond its faces, in the neighbours.
// 3. Then each thread computes one half-edge at a time and writes it, consecutive threads to
//    consecutive words.
// Along each axis a brick has a lower and an upper neighbour. Face f is perpendicular to axis f /
// 2, at the lower side if f is even, else at the upper side.
#include "cuda/extract/brick_warp.cuh"
#include "cuda/extract/extract_stages.cuh"
#include "cuda/memory/launch.cuh"

namespace vdwmesh {
namespace {

constexpr unsigned kTriangleThreads = 4 * kWarp;
constexpr int kMostTriangles = kMaxCaseTriangles * kBrickNodes;
constexpr int kCellsPerFace = kBrickSide * kBrickSide;

// Index into TriangleNeighbours::place of the neighbour at an offset of 0 or 1 along each axis; -1
// if all are 0, which means the brick itself.
__host__ __device__ constexpr int upper_neighbour(int dx, int dy, int dz) {
  return dx + 2 * dy + 4 * dz - 1;
}

// Index into TriangleNeighbours::place of the neighbour across a face: 7 + axis for a lower face,
// and upper_neighbour() with the offset along the axis for an upper one.
__host__ __device__ constexpr int neighbour_across(int face) {
  return face % 2 == 0 ? 7 + face / 2 : (1 << face / 2) - 1;
}

// The difference between the keys of neighbours along y and along z (see brick_key()); along x it
// is 1.
constexpr std::uint64_t kStepY = std::uint64_t{1} << 21, kStepZ = std::uint64_t{1} << 42;

// Index of the first key in keys[low .. high) that is at least `key`, or `high`.
__device__ std::uint32_t lower_bound_of_key(const std::uint64_t* keys, std::uint32_t low,
                                            std::uint32_t high, std::uint64_t key) {
  while (low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    if (keys[middle] < key) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

// Writes neighbours[own] of every brick. `keys` are the keys of all bricks, rising. Six threads per
// brick, one for each task; blockIdx.y is the task. Neighbours along x are next to each other in
// the list if both are in it, so the ten neighbours need only five binary searches:
// - task 0: the two neighbours along x, without a search;
// - tasks 1 to 3: the upper neighbour along y (1), along z (2), or along both (3), and the next
//   brick along x from there;
// - tasks 4 and 5: the lower neighbour along y or z.
__global__ void find_neighbours(const std::uint64_t* keys, std::uint32_t size,
                                TriangleNeighbours* neighbours) {
  const std::uint32_t own = blockIdx.x * blockDim.x + threadIdx.x;
  if (own >= size) return;
  std::uint32_t* place = neighbours[own].place;
  const std::uint64_t key = keys[own];
  // The index `at` if the brick there has the wanted key, else kNoBrick.
  const auto place_of = [&](std::uint32_t at, std::uint64_t wanted) {
    return at < size && keys[at] == wanted ? at : kNoBrick;
  };
  const auto task = static_cast<int>(blockIdx.y);
  if (task == 0) {
    // At x = 0 there is no lower neighbour, and key - 1 would borrow from y.
    const bool first = brick_of_key(key).x == 0 || own == 0;
    place[neighbour_across(0)] = first ? kNoBrick : place_of(own - 1, key - 1);
    place[upper_neighbour(1, 0, 0)] = place_of(own + 1, key + 1);
  } else if (task <= 3) {
    const int dy = task & 1, dz = task >> 1;
    const std::uint64_t wanted = key + (dy ? kStepY : 0) + (dz ? kStepZ : 0);
    const std::uint32_t at = lower_bound_of_key(keys, own + 1, size, wanted);
    // If the wanted brick is not in the list, `at` is where the next larger key stands, maybe
    // wanted + 1.
    const std::uint32_t there = place_of(at, wanted);
    place[upper_neighbour(0, dy, dz)] = there;
    place[upper_neighbour(1, dy, dz)] = place_of(there == kNoBrick ? at : at + 1, wanted + 1);
  } else {
    const bool along_y = task == 4;
    const BrickIndex index = brick_of_key(key);
    const bool first = (along_y ? index.y : index.z) == 0;
    const std::uint64_t wanted = key - (along_y ? kStepY : kStepZ);
    place[neighbour_across(along_y ? 2 : 4)] =
        first ? kNoBrick : place_of(lower_bound_of_key(keys, 0, own, wanted), wanted);
  }
}

// A row of eight nodes along x: from these two the number of each of its vertices follows
// (corner_number()).
struct alignas(8) VertexRow {
  std::uint32_t first;    // number in the mesh of the first vertex of the row
  std::uint32_t crossed;  // RowCrossings::packed
};

// A cell of the brick that the surface crosses.
struct alignas(4) MixedCell {
  std::uint16_t start;   // number of triangles in earlier cells of the brick
  std::uint16_t inside;  // its case, an index into CaseTable
};

// Shared memory of a thread block, about 11 KB. Cells are numbered 64 z + 8 y + x.
struct TriangleShared {
  ActiveBrick brick;
  TriangleNeighbours near;
  // rows[9 z + y] has the nodes x = 0 .. 7 of row (y, z), with y and z = 0 .. 8. The next 81
  // entries are the same rows in the next brick along x; of these only the first nodes are used,
  // which are this brick's nodes x = 8.
  VertexRow rows[2 * kRows];
  std::uint32_t before[4 * kBrickSide];   // crossings_before(x, axis), at 4 x + axis
  MixedCell cells[kBrickNodes];           // set for mixed cells only
  std::uint16_t cell_of[kMostTriangles];  // the cell of each triangle of the brick
  // The cells beyond each face, in the neighbour: first half-edge (its number in the mesh) and
  // case. [face][8 v + u], where u and v are the cell's coordinates along the two other axes, u
  // along the lower of them. Set for mixed cells only.
  std::uint32_t beyond_first[6][kCellsPerFace];
  std::uint8_t beyond_case[6][kCellsPerFace];
};

// The row with coordinates y and z = 0 .. 8, counted from the block's brick, of that brick (dx = 0)
// or of the next one along x (dx = 1). If y or z is 8, the row belongs to an upper neighbour, as
// row 0 there. If that neighbour is not in the list, the result is an empty row; count_missing()
// reports the neighbour if the surface goes there. y >> 3 is the neighbour's offset, y & 7 the row
// in it.
__device__ VertexRow vertex_row(const BrickList& list, const TriangleShared& s, std::uint32_t own,
                                int dx, int y, int z) {
  const int neighbour = upper_neighbour(dx, y >> 3, z >> 3);
  const std::uint64_t place = neighbour < 0 ? own : s.near.place[neighbour];
  if (place == kNoBrick) return {0, 0};
  const ActiveBrick& owner = neighbour < 0 ? s.brick : list.bricks[place];
  y &= kBrickSide - 1;
  z &= kBrickSide - 1;
  const std::uint64_t first = list.before[place].vertices + owner.row_vertices[z * kBrickSide + y];
  return {static_cast<std::uint32_t>(first), row_crossings(owner.signs, y, z).packed};
}

// Fills `rows` and `before`, by all threads of the block.
__device__ void share_vertex_rows(const BrickList& list, std::uint32_t own, TriangleShared& s) {
  for (unsigned i = threadIdx.x; i < 2 * kRows; i += kTriangleThreads) {
    const int row = static_cast<int>(i) % kRows, y = row % kBrickReach, z = row / kBrickReach;
    s.rows[i] = vertex_row(list, s, own, i < kRows ? 0 : 1, y, z);
  }
  if (threadIdx.x < 4 * kBrickSide) {
    const auto x = static_cast<int>(threadIdx.x) / 4, axis = static_cast<int>(threadIdx.x) % 4;
    s.before[threadIdx.x] = crossings_before(x, axis);
  }
}

// Fills `cells` and `cell_of`, by threads 0 .. 63, each for a row of cells: thread 8 z + y. `cells
// &= cells - 1` removes the lowest bit.
__device__ void share_own_cells(const CaseTable& table, TriangleShared& s) {
  const int y = static_cast<int>(threadIdx.x) % kBrickSide;
  const int z = static_cast<int>(threadIdx.x) / kBrickSide;
  std::uint32_t next = s.brick.row_triangles[threadIdx.x];
  const std::uint32_t mixed = mixed_cells(s.brick.signs, y, z);
  for (std::uint32_t cells = mixed; cells != 0; cells &= cells - 1) {
    const int x = __ffs(static_cast<int>(cells)) - 1;
    const auto cell =
        static_cast<std::uint16_t>(threadIdx.x * kBrickSide + static_cast<unsigned>(x));
    const std::uint32_t inside = cell_case(s.brick.signs, x, y, z);
    s.cells[cell] = {static_cast<std::uint16_t>(next), static_cast<std::uint16_t>(inside)};
    const std::uint32_t end = next + table.count(inside);
    while (next < end) s.cell_of[next++] = cell;
  }
}

// Enters a cell beyond a face, at index `uv` = 8 v + u. `triangles_before` counts the triangles of
// the mesh before it.
__device__ void share_cell_beyond(TriangleShared& s, int face, int uv, std::uint32_t inside,
                                  std::uint64_t triangles_before) {
  s.beyond_case[face][uv] = static_cast<std::uint8_t>(inside);
  s.beyond_first[face][uv] = static_cast<std::uint32_t>(3 * triangles_before);
}

// Enters the cells beyond the faces across y and z: by 32 threads, each for a row of eight cells
// along x.
__device__ void share_rows_beyond(const BrickList& list, const CaseTable& table, TriangleShared& s,
                                  int thread) {
  const int face = 2 + thread / kBrickSide, v = thread % kBrickSide;
  const std::uint32_t place = s.near.place[neighbour_across(face)];
  if (place == kNoBrick) return;
  const ActiveBrick& owner = list.bricks[place];
  // The layer of the neighbour next to this brick: its last one beyond a lower face, else its
  // first.
  const int last = face % 2 == 0 ? kBrickSide - 1 : 0;
  const int y = face / 2 == 1 ? last : v, z = face / 2 == 1 ? v : last;
  std::uint64_t before = list.before[place].triangles + owner.row_triangles[z * kBrickSide + y];
  const std::uint32_t mixed = mixed_cells(owner.signs, y, z);
  for (std::uint32_t cells = mixed; cells != 0; cells &= cells - 1) {
    const int x = __ffs(static_cast<int>(cells)) - 1;
    const std::uint32_t inside = cell_case(owner.signs, x, y, z);
    share_cell_beyond(s, face, v * kBrickSide + x, inside, before);
    before += table.count(inside);
  }
}

// Enters the cells beyond the two faces across x: by 32 threads, each for two cells of either face.
// Such a cell is the last of its row (in the neighbour) beyond the lower face, and the first beyond
// the upper face. The number of triangles before a row is known from counting. The last cell's
// triangles end where the next row's begin, so they begin that much less the cell's triangles.
__device__ void share_ends_beyond(const BrickList& list, const CaseTable& table, TriangleShared& s,
                                  int thread) {
  for (int i = thread; i < 2 * kCellsPerFace; i += static_cast<int>(kWarp)) {
    const int face = i / kCellsPerFace, row = i % kCellsPerFace;
    const std::uint32_t place = s.near.place[neighbour_across(face)];
    if (place == kNoBrick) continue;
    const ActiveBrick& owner = list.bricks[place];
    const int x = face == 0 ? kBrickSide - 1 : 0, y = row % kBrickSide, z = row / kBrickSide;
    const std::uint32_t inside = cell_case(owner.signs, x, y, z);
    if (table.count(inside) == 0) continue;
    std::uint64_t before = list.before[place].triangles + owner.row_triangles[row];
    if (face == 0) {
      const std::uint64_t end = row + 1 < kCellsPerFace
                                    ? list.before[place].triangles + owner.row_triangles[row + 1]
                                    : list.before[place + 1].triangles;
      before = end - table.count(inside);
    }
    share_cell_beyond(s, face, row, inside, before);
  }
}

// Enters the cells beyond all faces, by two warps; `thread` is 0 .. 63.
__device__ void share_cells_beyond(const BrickList& list, const CaseTable& table, TriangleShared& s,
                                   int thread) {
  if (thread < static_cast<int>(kWarp)) {
    share_rows_beyond(list, table, s, thread);
  } else {
    share_ends_beyond(list, table, s, thread - static_cast<int>(kWarp));
  }
}

// Checks that the list has all bricks that it needs. Adds to `missing` the number of rows of cells
// at the brick's faces which the surface crosses although the brick beyond the face is not in the
// list. By 48 threads, each for one face and one row of cells. A row of cells counts as crossed if
// its nodes in the face (2 x 9) are of both signs. A brick that only shares an edge with this one
// needs no check of its own: if the surface crosses that edge, it crosses the faces that contain
// the edge. Two other bricks share faces with both, so the checks of the faces report the missing
// brick.
__device__ void count_missing(const TriangleShared& s, int thread, unsigned long long* missing) {
  const int face = thread / kBrickSide, v = thread % kBrickSide;
  if (face >= 6 || s.near.place[neighbour_across(face)] != kNoBrick) return;
  const int axis = face / 2, node = face % 2 * kBrickSide;
  const auto& row = s.brick.signs.row;
  // The nodes of the face in one row along x: for a face across x a single node, else nine.
  const unsigned all = axis == 0 ? 1u : (1u << kBrickReach) - 1;
  unsigned any = 0, every = all;
  const auto add = [&](unsigned nodes) {
    any |= nodes & all;
    every &= nodes;
  };
  if (axis == 0) {
    for (int y = 0; y < kBrickReach; ++y) {
      add(row[v][y] >> node);
      add(row[v + 1][y] >> node);
    }
  } else if (axis == 1) {
    add(row[v][node]);
    add(row[v + 1][node]);
  } else {
    add(row[node][v]);
    add(row[node][v + 1]);
  }
  if (any != 0 && every != all) atomicAdd(missing, 1ull);
}

// Number in the mesh of the vertex on the edge that node (x, y, z), each 0 .. 8, owns along the
// axis: the row's first vertex plus the number of crossed edges of the row before this one.
__device__ std::uint32_t corner_number(const TriangleShared& s, unsigned x, unsigned y, unsigned z,
                                       unsigned axis) {
  const VertexRow row = s.rows[(x / kBrickSide) * kRows + z * kBrickReach + y];
  const std::uint32_t before = s.before[4 * (x % kBrickSide) + axis];
  return row.first + static_cast<std::uint32_t>(__popc(row.crossed & before));
}

// Number in the mesh of the opposite of a half-edge that lies in a face of its cell. The opposite
// belongs to the cell across that face. `base` is the number of the brick's first half-edge, `cell`
// the cell 64 z + 8 y + x. `code` = 4 face + slot is the half-edge's CaseTable::across less
// kFirstFaceCode; the slot names one of the face's four edges. The three bits of `cell` from
// `shift` on are its coordinate along the face's axis.
__device__ std::uint32_t number_across(const TriangleShared& s, const CaseTable& table,
                                       std::uint32_t base, unsigned cell, std::uint32_t code) {
  const unsigned face = code / 4, slot = code % 4, shift = 3 * (face / 2);
  const bool upper = face % 2 != 0;
  const unsigned at = cell >> shift & (kBrickSide - 1);
  // The same face as the other cell numbers it: lower and upper are exchanged.
  const auto entry = static_cast<int>(face ^ 1);
  if (at == (upper ? kBrickSide - 1u : 0u)) {
    // The cell's place in the face, 8 v + u: `cell` without the coordinate along the face's axis.
    const unsigned uv = (cell & ((1u << shift) - 1)) | (cell >> (shift + 3)) << shift;
    return s.beyond_first[face][uv] +
           table.at_face(s.beyond_case[face][uv], entry, static_cast<int>(slot));
  }
  const unsigned beyond = upper ? cell + (1u << shift) : cell - (1u << shift);
  const MixedCell there = s.cells[beyond];
  return base + 3 * there.start + table.at_face(there.inside, entry, static_cast<int>(slot));
}

// Writes the corners of a brick's triangles and, if half-edges are asked for, the opposite
// half-edges. A thread block of 128 threads per brick; block b works on brick first + b of the
// list. About 11 KB of shared memory. Half-edge n of the brick goes to index 3 * (number of the
// brick's first triangle - mesh.first_triangle) + n. The cells beyond the faces are gathered for
// half-edges only.
template <Connectivity connectivity>
__global__ void __launch_bounds__(kTriangleThreads)
    emit_triangles(BrickList list, std::uint32_t first, const TriangleNeighbours* neighbours,
                   const CaseTable* global_table, DeviceMeshView mesh,
                   unsigned long long* missing) {
  __shared__ TriangleShared s;
  const CaseTable& table = *global_table;
  const std::uint32_t own = first + blockIdx.x;
  copy_brick(&list.bricks[own], &s.brick, threadIdx.x, kTriangleThreads);
  // The last ten threads copy one neighbour each, as the first ones are busy with the brick.
  if (threadIdx.x >= kTriangleThreads - kTriangleNeighbours) {
    const unsigned slot = threadIdx.x - (kTriangleThreads - kTriangleNeighbours);
    s.near.place[slot] = neighbours[own].place[slot];
  }
  __syncthreads();
  if (s.brick.triangles == 0) return;
  const auto thread = static_cast<int>(threadIdx.x);
  constexpr bool half_edges = connectivity == Connectivity::half_edges;
  if (thread < kOwnRows) {
    share_own_cells(table, s);
  } else {
    count_missing(s, thread - kOwnRows, missing);
    if constexpr (half_edges) share_cells_beyond(list, table, s, thread - kOwnRows);
  }
  share_vertex_rows(list, own, s);
  __syncthreads();
  // A thread takes every 128th half-edge n of the brick. The triangle n / 3 gives the cell, and h
  // is the half-edge's number among the half-edges of the cell's case. It is written as the corner
  // at which it starts.
  const std::uint64_t before = list.before[own].triangles;
  const auto base_number = static_cast<std::uint32_t>(3 * before);
  const std::uint64_t place = 3 * (before - mesh.first_triangle);
  for (std::uint32_t n = threadIdx.x; n < 3 * s.brick.triangles; n += kTriangleThreads) {
    const unsigned cell = s.cell_of[n / 3];
    const MixedCell own_cell = s.cells[cell];
    const std::uint32_t h = n - 3 * own_cell.start;
    const PackedHalfEdge edge = table.half_edge[own_cell.inside][h];
    const unsigned x = cell % kBrickSide, y = cell / kBrickSide % kBrickSide;
    const unsigned z = cell / kCellsPerFace;
    mesh.corners[place + n] =
        corner_number(s, x + static_cast<unsigned>(edge.x()), y + static_cast<unsigned>(edge.y()),
                      z + static_cast<unsigned>(edge.z()), static_cast<unsigned>(edge.axis()));
    if constexpr (half_edges) {
      // A low code is the number of the opposite in the same cell, whose half-edges begin at n - h.
      const std::uint32_t code = edge.across();
      mesh.opposite[place + n] =
          code < kFirstFaceCode ? base_number + n - h + code
                                : number_across(s, table, base_number, cell, code - kFirstFaceCode);
    }
  }
}

}  // namespace

DeviceArray<TriangleNeighbours> find_triangle_neighbours(const KeyList& keys,
                                                         const Stream& stream) {
  if (keys.count >= kNoBrick) throw LimitExceeded("more bricks than 32 bits number");
  DeviceArray<TriangleNeighbours> neighbours(keys.count, stream.get());
  constexpr unsigned threads = 128;
  launch("find_neighbours", find_neighbours, {dim3(blocks_for(keys.count, threads), 6), threads},
         stream, keys.keys.data(), static_cast<std::uint32_t>(keys.count), neighbours.data());
  return neighbours;
}

void emit_triangles_on_device(const BrickList& bricks,
                              const DeviceArray<TriangleNeighbours>& neighbours,
                              const BrickRange& range, const DeviceMeshView& mesh,
                              DeviceEmissionTally* tally, const Stream& stream) {
  const auto kernel = mesh.opposite != nullptr ? emit_triangles<Connectivity::half_edges>
                                               : emit_triangles<Connectivity::triangles>;
  launch("emit_triangles", kernel, {static_cast<unsigned>(range.size()), kTriangleThreads}, stream,
         bricks, static_cast<std::uint32_t>(range.begin), neighbours.data(), case_table_on_device(),
         mesh, &tally->missing_neighbours);
}

}  // namespace vdwmesh
