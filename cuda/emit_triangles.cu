// Triangles and their half-edges, a block of threads per brick. First the block lays out in shared
// memory what the numbers are made from, then a thread writes a half-edge at a time, in order.
#include "cuda/brick_block.cuh"
#include "cuda/extract_stages.cuh"

namespace vdwmesh {
namespace {

constexpr int kMostTriangles = kMaxCaseTriangles * kBrickNodes;
constexpr int kCellsPerFace = kBrickSide * kBrickSide;
constexpr std::uint64_t kNoBrick = ~std::uint64_t{0};

struct TriangleShared {
  ActiveBrick brick;
  std::uint64_t neighbour[kNeighbours];
  // Nodes x = 0 .. 7 of row (z, y), and node x = 8: number of the first vertex, crossings.
  std::uint32_t row_first[kRows], last_first[kRows];
  std::uint32_t row_crossed[kRows], last_crossed[kRows];  // a byte per axis
  std::uint16_t cell_start[kBrickNodes];                  // triangles before each cell
  std::uint16_t cell_of[kMostTriangles];
  // Cells across each face: first half-edge and case.
  std::uint32_t beyond_first[6][kCellsPerFace];
  std::uint8_t beyond_case[6][kCellsPerFace];
};

__device__ std::uint32_t pack(const RowCrossings& c) {
  return c.along[0] | c.along[1] << 8 | c.along[2] << 16;
}

__device__ RowCrossings unpack(std::uint32_t packed) {
  return {{packed & 255u, packed >> 8 & 255u, packed >> 16}};
}

// Places of the neighbours; kNoBrick where a neighbour is not in the list and so holds no surface.
__device__ void share_neighbours(const BrickList& list, TriangleShared& s) {
  if (threadIdx.x < kNeighbours) {
    const auto slot = static_cast<int>(threadIdx.x);
    const BrickIndex own = brick_of_key(s.brick.key);
    const BrickIndex b{own.x + slot % 3 - 1, own.y + slot / 3 % 3 - 1, own.z + slot / 9 - 1};
    std::uint64_t place = kNoBrick;
    if (b.x >= 0 && b.y >= 0 && b.z >= 0) {
      place = find_brick(list, brick_key(b));
      if (place == list.size || list.bricks[place].key != brick_key(b)) place = kNoBrick;
    }
    s.neighbour[slot] = place;
  }
  __syncthreads();
}

// First vertex and crossings of row (y & 7, z & 7) of the brick at (dx, y >> 3, z >> 3).
__device__ void share_row(const BrickList& list, const TriangleShared& s, int dx, int y, int z,
                          std::uint32_t& first, std::uint32_t& crossed) {
  const std::uint64_t place = s.neighbour[neighbour_slot(dx, y >> 3, z >> 3)];
  first = 0;
  crossed = 0;
  if (place == kNoBrick) return;
  const ActiveBrick& owner = list.bricks[place];
  y &= kBrickSide - 1;
  z &= kBrickSide - 1;
  first = static_cast<std::uint32_t>(list.vertices[place] + owner.row_vertices[z * kBrickSide + y]);
  crossed = pack(row_crossings(owner.signs, y, z));
}

__device__ void share_vertex_rows(const BrickList& list, TriangleShared& s) {
  for (unsigned i = threadIdx.x; i < 2 * kRows; i += kBrickThreads) {
    const int row = static_cast<int>(i) % kRows, y = row % kBrickReach, z = row / kBrickReach;
    if (i < kRows) {
      share_row(list, s, 0, y, z, s.row_first[row], s.row_crossed[row]);
    } else {
      share_row(list, s, 1, y, z, s.last_first[row], s.last_crossed[row]);
    }
  }
}

__device__ void share_own_cells(const CaseTable& table, TriangleShared& s) {
  if (threadIdx.x >= kOwnRows) return;
  const int y = static_cast<int>(threadIdx.x) % kBrickSide;
  const int z = static_cast<int>(threadIdx.x) / kBrickSide;
  std::uint32_t next = s.brick.row_triangles[threadIdx.x];
  const std::uint32_t mixed = mixed_cells(s.brick.signs, y, z);
  for (int x = 0; x < kBrickSide; ++x) {
    const auto cell =
        static_cast<std::uint16_t>(threadIdx.x * kBrickSide + static_cast<unsigned>(x));
    s.cell_start[cell] = static_cast<std::uint16_t>(next);
    if ((mixed >> x & 1) == 0) continue;
    const std::uint32_t end = next + table.count(cell_case(s.brick.signs, x, y, z));
    while (next < end) s.cell_of[next++] = cell;
  }
}

// Cell (u, v) of a face in the coordinates of the brick beyond it.
__device__ Located cell_beyond(std::uint64_t brick, int face, int u, int v) {
  const int last = face % 2 == 0 ? kBrickSide - 1 : 0, axis = face / 2;
  if (axis == 0) return {brick, last, u, v};
  if (axis == 1) return {brick, u, last, v};
  return {brick, u, v, last};
}

__device__ int slot_beyond(int face) {
  const int step = face % 2 == 0 ? -1 : 1, axis = face / 2;
  return neighbour_slot(axis == 0 ? step : 0, axis == 1 ? step : 0, axis == 2 ? step : 0);
}

__device__ void share_cells_beyond(const BrickList& list, const CaseTable& table,
                                   TriangleShared& s) {
  for (unsigned i = threadIdx.x; i < 6 * kCellsPerFace; i += kBrickThreads) {
    const int face = static_cast<int>(i) / kCellsPerFace, uv = static_cast<int>(i) % kCellsPerFace;
    const std::uint64_t place = s.neighbour[slot_beyond(face)];
    if (place == kNoBrick) continue;
    const Located cell = cell_beyond(place, face, uv % kBrickSide, uv / kBrickSide);
    const std::uint32_t inside = cell_case(list.bricks[place].signs, cell.x, cell.y, cell.z);
    if (table.count(inside) == 0) continue;
    s.beyond_case[face][uv] = static_cast<std::uint8_t>(inside);
    s.beyond_first[face][uv] = static_cast<std::uint32_t>(first_half_edge(list, table, cell));
  }
}

__device__ std::uint32_t corner_number(const TriangleShared& s, int x, int y, int z, int axis) {
  const int row = z * kBrickReach + y;
  const bool own = x < kBrickSide;
  const RowCrossings c = unpack(own ? s.row_crossed[row] : s.last_crossed[row]);
  return (own ? s.row_first[row] : s.last_first[row]) +
         static_cast<std::uint32_t>(place_in_row(c, own ? x : 0, axis));
}

__device__ std::uint32_t opposite_number(const TriangleShared& s, const CaseTable& table,
                                         std::uint64_t base, int cell, std::uint32_t inside,
                                         int h) {
  const auto first_of = [&](int c) {
    return static_cast<std::uint32_t>(3 * (base + s.cell_start[c]));
  };
  const int code = table.across_code(inside, h);
  if (code < kFirstFaceCode) return first_of(cell) + static_cast<std::uint32_t>(code);
  const int face = (code - kFirstFaceCode) / 4, slot = (code - kFirstFaceCode) % 4;
  const int axis = face / 2, step = face % 2 == 0 ? -1 : 1;
  const int x = cell % kBrickSide, y = cell / kBrickSide % kBrickSide, z = cell / kCellsPerFace;
  const int at = (axis == 0 ? x : (axis == 1 ? y : z)) + step;
  if (at < 0 || at >= kBrickSide) {
    const int uv = (axis == 2 ? y : z) * kBrickSide + (axis == 0 ? y : x);
    return s.beyond_first[face][uv] + table.at_face(s.beyond_case[face][uv], face ^ 1, slot);
  }
  const int stride = axis == 0 ? 1 : (axis == 1 ? kBrickSide : kCellsPerFace);
  const std::uint32_t beyond = cell_case(s.brick.signs, x + (axis == 0 ? step : 0),
                                         y + (axis == 1 ? step : 0), z + (axis == 2 ? step : 0));
  return first_of(cell + step * stride) + table.at_face(beyond, face ^ 1, slot);
}

__global__ void __launch_bounds__(kBrickThreads)
    emit_triangles(BrickList list, const CaseTable* global_table, DeviceMeshView mesh) {
  __shared__ TriangleShared s;
  const CaseTable& table = *global_table;
  copy_brick(&list.bricks[blockIdx.x], &s.brick);
  __syncthreads();
  if (s.brick.triangles == 0) return;
  share_neighbours(list, s);
  share_vertex_rows(list, s);
  share_own_cells(table, s);
  share_cells_beyond(list, table, s);
  __syncthreads();
  const std::uint64_t base = list.triangles[blockIdx.x];
  for (std::uint32_t n = threadIdx.x; n < 3 * s.brick.triangles; n += kBrickThreads) {
    const int cell = s.cell_of[n / 3];
    const int x = cell % kBrickSide, y = cell / kBrickSide % kBrickSide, z = cell / kCellsPerFace;
    const std::uint32_t inside = cell_case(s.brick.signs, x, y, z);
    const int h = static_cast<int>(n) - 3 * s.cell_start[cell];
    const CellEdge edge = cell_edge(table.edges[inside][h]);
    mesh.corners[3 * base + n] = corner_number(s, x + edge.x, y + edge.y, z + edge.z, edge.axis);
    mesh.opposite[3 * base + n] = opposite_number(s, table, base, cell, inside, h);
  }
}

}  // namespace

void emit_triangles_on_device(const BrickList& bricks, const CaseTable* table,
                              const DeviceMeshView& mesh, const Stream& stream) {
  if (bricks.size == 0) return;
  emit_triangles<<<static_cast<unsigned>(bricks.size), kBrickThreads, 0, stream.get()>>>(
      bricks, table, mesh);
  check_launch("emit_triangles");
}

}  // namespace vdwmesh
