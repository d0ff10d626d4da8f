// Device functions for kernels in which one warp works on one brick: the geometry of the brick in
// shared memory, counting from the node signs, and writing its vertices. "share" in a name means
// that a warp fills a structure in shared memory for all of its lanes. The rows of a brick run
// along x; row (y, z) has number 8 z + y.
#pragma once

#include <cstddef>

#include "cuda/extract/bricks/extract_stages.cuh"
#include "cuda/extract/bricks/ordered_gather.cuh"
#include "extract/bricks/brick_geometry.hpp"
#include "extract/bricks/brick_numbering.hpp"
#include "extract/bricks/case_table.hpp"
#include "extract/bricks/edge_vertex.hpp"

namespace vdwmesh {

// Warps of a thread block. A block keeps its registers and shared memory until its slowest warp
// ends, so few warps are better.
inline constexpr unsigned kBrickWarps = 2;
inline constexpr unsigned kBrickThreads = kBrickWarps * kWarp;
inline constexpr int kRows = kBrickReach * kBrickReach;  // 9 x 9 rows of nodes that the cells touch
inline constexpr int kOwnRows = kBrickSide * kBrickSide;  // 8 x 8 rows of own nodes, or of cells

// Keeps the compiler from moving the load of a value behind what follows, for instance into the
// branch that uses it: so loads that do not depend on each other are under way together.
__device__ inline void load_now(std::uint64_t value) { asm volatile("" ::"l"(value)); }
__device__ inline void load_now(std::uint32_t value) { asm volatile("" ::"r"(value)); }
__device__ inline void load_now(float value) { asm volatile("" ::"f"(value)); }

// Stores row (y, z) of the brick's signs. Bit x of `inside` says whether node x is inside; if the
// node is virtual, its bit is ignored, and it is outside.
__device__ inline void share_signs(const BrickGeometry& g, std::uint32_t inside, int y, int z,
                                   BrickSigns& signs) {
  const bool real = (g.real[1] >> y & g.real[2] >> z & 1) != 0;
  signs.row[z][y] = real ? static_cast<std::uint16_t>(inside & g.real[0]) : std::uint16_t{0};
}

enum class NodeCoordinates : std::uint8_t { made, left_out };

// Computes brick_geometry() by one warp, with or without the coordinates: lane 9 * axis + i makes
// node i along the axis; five lanes are idle. Ends with __syncwarp().
template <NodeCoordinates coordinates = NodeCoordinates::made>
__device__ inline void share_geometry(const GridSpec& grid, std::uint64_t key, BrickGeometry& g) {
  const BrickIndex brick = brick_of_key(key);
  const auto lane = static_cast<int>(threadIdx.x % kWarp);
  const int axis = lane / kBrickReach, i = lane % kBrickReach;
  const std::int32_t index = axis == 0 ? brick.x : (axis == 1 ? brick.y : brick.z);
  const std::int64_t lattice = lattice_index(index, i);
  // The vote has the nine bits of BrickGeometry::real for each axis, one axis behind the other.
  const unsigned real = __ballot_sync(kAllLanes, axis < 3 && !is_virtual(grid, axis, lattice));
  if (lane == 0) g.brick = brick;
  if (axis < 3) {
    if constexpr (coordinates == NodeCoordinates::made) {
      g.coordinate[axis][i] = lattice_coordinate(grid, axis, lattice);
    }
    constexpr unsigned nodes = (1u << kBrickReach) - 1;
    if (i == 0) g.real[axis] = static_cast<std::uint16_t>(real >> (kBrickReach * axis) & nodes);
  }
  __syncwarp();
}

// Copies a brick between global and shared memory, 8 bytes a thread and step. It is called by
// `threads` threads, each with its own number `thread` from 0 on. The caller must synchronise
// afterwards.
__device__ inline void copy_brick(const ActiveBrick* from, ActiveBrick* to, unsigned thread,
                                  unsigned threads) {
  static_assert(sizeof(ActiveBrick) % sizeof(std::uint64_t) == 0);
  const auto* source = reinterpret_cast<const std::uint64_t*>(from);
  auto* target = reinterpret_cast<std::uint64_t*>(to);
  for (unsigned w = thread; w < sizeof(ActiveBrick) / sizeof(std::uint64_t); w += threads) {
    target[w] = source[w];
  }
}

// Counts the vertices and triangles that follow from the brick's signs, and their prefix sums over
// the rows. By one warp: each lane has two neighbouring rows, which share most of their signs. What
// belongs to the first row is in the lower 16 bits of a word, what belongs to the second in the
// upper ones, so the bit operations of row_crossings(), mixed_cells() and cell_case() serve both.
// Counts of vertices and triangles are packed into one word of 2 x 16 bits, so one prefix sum
// serves both; 16 bits suffice for at most 1536 vertices and 2560 triangles. The caller
// synchronises before and after.
__device__ inline void count_brick(const BrickGeometry& geometry, const CaseTable& table,
                                   ActiveBrick& brick) {
  static_assert(kOwnRows == 2 * kWarp && kBrickSide % 2 == 0 && kBrickReach < 16);
  // The counts before two rows are written as one word.
  static_assert(offsetof(ActiveBrick, row_vertices) % 4 == 0 &&
                offsetof(ActiveBrick, row_triangles) % 4 == 0);
  const unsigned lane = threadIdx.x % kWarp;
  const int row = 2 * static_cast<int>(lane), y = row % kBrickSide, z = row / kBrickSide;
  const auto both = [&](int dy, int dz) {
    const std::uint16_t* const first = &brick.signs.row[z + dz][y + dy];
    return first[0] | static_cast<std::uint32_t>(first[1]) << 16;
  };
  const std::uint32_t a = both(0, 0), b = both(1, 0), c = both(0, 1), d = both(1, 1);
  constexpr std::uint32_t own = 0x00ff00ffu, lower = 0xffffu;
  const std::uint32_t along_xy = ((a ^ a >> 1) & own) | ((a ^ b) & own) << 8;
  const std::uint32_t along_z = (a ^ c) & own;
  const auto vertices = static_cast<std::uint32_t>(__popc((along_xy & lower) | along_z << 16));
  const auto next_vertices =
      static_cast<std::uint32_t>(__popc(along_xy >> 16 | (along_z & ~lower)));
  const std::uint32_t any = a | b | c | d, all = a & b & c & d;
  const std::uint32_t mixed = (any | any >> 1) & ~(all & all >> 1) & own;
  std::uint32_t triangles = 0;  // of the second row in the upper half
  for (std::uint32_t cells = mixed; cells != 0; cells &= cells - 1) {
    const int x = __ffs(static_cast<int>(cells)) - 1;
    const std::uint32_t inside =
        (a >> x & 3u) | (b >> x & 3u) << 2 | (c >> x & 3u) << 4 | (d >> x & 3u) << 6;
    triangles += table.count(inside) << (x & 16);
  }
  const std::uint32_t first = triangles << 16 | vertices;
  const std::uint32_t second = (triangles & ~lower) | next_vertices;
  const std::uint32_t sum = warp_inclusive_sum(first + second);
  // Triangles << 16 | vertices of the rows before the first row, and before the second.
  const std::uint32_t before = sum - first - second, between = before + first;
  reinterpret_cast<std::uint32_t*>(brick.row_vertices)[lane] = __byte_perm(before, between, 0x5410);
  reinterpret_cast<std::uint32_t*>(brick.row_triangles)[lane] =
      __byte_perm(before, between, 0x7632);
  std::uint32_t clipped = 0;
  if (geometry.has_virtual_nodes()) {
    const std::uint32_t first_border = border_cells(geometry, y, z);
    const std::uint32_t border = first_border | border_cells(geometry, y + 1, z) << 16;
    clipped = __reduce_add_sync(kAllLanes, static_cast<std::uint32_t>(__popc(mixed & border)));
  }
  if (lane != kWarp - 1) return;
  brick.vertices = sum & lower;
  brick.triangles = sum >> 16;
  brick.clipped_cells = clipped;
}

// Writes a counted brick to bricks[i], and adds its counts to `counts`. By one warp.
__device__ inline void store_count(const ActiveBrick& brick, std::uint64_t i, ActiveBrick* bricks,
                                   const BrickCounts& counts) {
  const unsigned lane = threadIdx.x % kWarp;
  copy_brick(&brick, &bricks[i], lane, kWarp);
  if (lane != 0) return;
  counts.sums[i] = {brick.vertices, brick.triangles};
  CountPart& part = counts.parts[i % kCountParts];
  if (brick.clipped_cells != 0) atomicAdd(&part.clipped_cells, brick.clipped_cells);
  if (brick.vertices + brick.triangles != 0) atomicAdd(&part.surface_bricks, 1ull);
}

// Spreads the 8 low bits: bit i moves to bit 3 i. Each step splits every group of bits and moves
// its upper half away, until all groups are single bits.
__device__ inline std::uint32_t spread_by_three(std::uint32_t bits) {
  bits = (bits | bits << 8) & 0x00f00fu;
  bits = (bits | bits << 4) & 0x0c30c3u;
  return (bits | bits << 2) & 0x249249u;
}

// Position of the n-th set bit, n counted from 0, by a binary search over population counts. If the
// lower half of what is left has n bits or fewer, the bit is in the upper half. Precondition: more
// than n bits are set.
__device__ inline int nth_bit(std::uint32_t bits, int n) {
  int place = 0;
  for (int width = 16; width > 0; width /= 2) {
    const int below = __popc(bits >> place & ((1u << width) - 1));
    if (n < below) continue;
    n -= below;
    place += width;
  }
  return place;
}

// The crossed edge that carries vertex n of a brick (n counted from 0 within the brick): a binary
// search for its row, then for its bit in the row. So any lane can compute any vertex without a
// list of edges.
__device__ inline CrossedEdge edge_of_vertex(const ActiveBrick& brick, std::uint32_t n) {
  int row = 0;  // the last row whose first vertex is at most n
  for (int step = kOwnRows / 2; step > 0; step /= 2) {
    if (brick.row_vertices[row + step] <= n) row += step;
  }
  const int y = row % kBrickSide, z = row / kBrickSide;
  const RowCrossings c = row_crossings(brick.signs, y, z);
  // Bit 3 x + axis, in the order of the vertices: by node, then by axis.
  const std::uint32_t crossed = spread_by_three(c.along(0)) | spread_by_three(c.along(1)) << 1 |
                                spread_by_three(c.along(2)) << 2;
  const int place = nth_bit(crossed, static_cast<int>(n - brick.row_vertices[row]));
  const int x = place / 3;
  return crossed_edge((brick.signs.row[z][y] >> x & 1) != 0, x, y, z, place % 3);
}

// Shared memory in which a warp rearranges the vertices of its lanes: each lane has three
// coordinates, but consecutive lanes shall write consecutive words of global memory (coalesced
// writes).
struct VertexStage {
  double position[3 * kWarp];
  float normal[3 * kWarp];
};

// Writes `count` vertices, of which lane i holds the i-th, to the arrays of the mesh from index
// `first` on. All lanes of the warp call it.
__device__ inline void store_vertices(VertexStage& stage, const DeviceMeshView& mesh,
                                      std::uint64_t first, unsigned count,
                                      const EdgeVertex& vertex) {
  const unsigned lane = threadIdx.x % kWarp;
  // The lanes may still be reading the vertices of the call before.
  __syncwarp();
  const bool with_normals = mesh.normals != nullptr;
  for (int axis = 0; axis < 3; ++axis) {
    stage.position[3 * lane + static_cast<unsigned>(axis)] = vertex.position[axis];
    if (with_normals) stage.normal[3 * lane + static_cast<unsigned>(axis)] = vertex.normal[axis];
  }
  __syncwarp();
  auto* positions = reinterpret_cast<double*>(mesh.positions + first);
  auto* normals = reinterpret_cast<float*>(mesh.normals + first);
#pragma unroll
  for (unsigned turn = 0; turn < 3; ++turn) {
    const unsigned w = lane + turn * kWarp;
    if (w >= 3 * count) break;
    positions[w] = stage.position[w];
    if (with_normals) normals[w] = stage.normal[w];
  }
  if (mesh.vertex_spheres.atoms && lane < count) {
    mesh.vertex_spheres.atoms[first + lane] = vertex.sphere;
  }
}

// Which part of a brick is a warp's, if several share the brick: of every `of` times 32 vertices,
// the 32 with this number.
struct WarpShare {
  unsigned number, of;
};

// Computes vertex(edge) for a share of the vertices of a brick, 32 at a time, and writes them by
// one warp. `base` is the number of the brick's first vertex in the whole mesh. Adds the number of
// clamped vertices to `clamped`. All lanes of the warp call it, and all call vertex() together.
template <class Vertex>
__device__ void store_vertices_of(const ActiveBrick& brick, const WarpShare& share,
                                  std::uint64_t base, VertexStage& stage,
                                  const DeviceMeshView& mesh, unsigned long long* clamped,
                                  Vertex vertex) {
  const std::uint64_t place = base - mesh.first_vertex;
  const unsigned lane = threadIdx.x % kWarp;
  for (std::uint32_t first = share.number * kWarp; first < brick.vertices;
       first += share.of * kWarp) {
    const std::uint32_t left = brick.vertices - first;
    const unsigned count = left < kWarp ? left : kWarp;
    // Lanes without a vertex repeat the last one, because vertex() may synchronise the warp.
    const unsigned own = lane < count ? lane : count - 1;
    const EdgeVertex v = vertex(edge_of_vertex(brick, first + own));
    if (lane < count && v.clamped) atomicAdd(clamped, 1ull);
    store_vertices(stage, mesh, place + first, count, v);
  }
}

}  // namespace vdwmesh
