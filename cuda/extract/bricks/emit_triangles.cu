// Writes the triangles of the bricks, and on request their opposite half-edges, with a group of two
// warps per brick. It is the device counterpart of TriangleEmitter; the numbers are the same.
// 1. find_triangle_neighbours() (triangle_neighbours.cu) has found each brick's neighbours.
// 2. emit_triangles gathers in shared memory all that is needed to compute the numbers of a brick's
//    vertices and half-edges: its mixed cells (which the surface crosses) with their first
//    triangles, and first vertices and crossed edges of its rows of nodes (triangle_shared.cuh).
// 3. Of the neighbours it takes only what lies beyond faces that the surface crosses: rows of nodes
//    and, for half-edges, mixed cells.
// 4. Then each lane computes one triangle at a time, and a warp writes 32 of them together.
// A thread block of several groups fills a good part of a multiprocessor. It copies the tables of
// the cases to shared memory once, and its groups then take bricks until none is left.
// Along each axis a brick has a lower and an upper neighbour. Face f is perpendicular to axis f /
// 2, at the lower side if f is even, else at the upper side.
#include <algorithm>

#include "cuda/extract/bricks/extract_stages.cuh"
#include "cuda/extract/bricks/triangle_shared.cuh"
#include "cuda/memory/device.cuh"
#include "cuda/memory/launch.cuh"

namespace vdwmesh {
namespace {

// ---- what lies beyond the faces ----

// Returns row (y, z) of the group's brick (dx = 0) or of the next brick along x (dx = 1), where y
// or z is 8, so that an upper neighbour owns the row. y >> 3 and z >> 3 are the neighbour's
// offsets, y & 7 and z & 7 the row there. If the neighbour is not in the list, the result is an
// empty row; check_neighbours() reports the neighbour if the surface goes there. `before_mesh` is
// the number of vertices of the list before those of the brick's mesh.
__device__ VertexRow row_beyond(const BrickList& list, std::uint64_t before_mesh,
                                const TriangleNeighbours& near, int dx, int y, int z) {
  const std::uint32_t place = near.place[upper_neighbour(dx, y >> 3, z >> 3)];
  if (place == kNoBrick) return {0, 0};
  const ActiveBrick& owner = list.bricks[place];
  y &= kBrickSide - 1;
  z &= kBrickSide - 1;
  const std::uint64_t first =
      list.before[place].vertices - before_mesh + owner.row_vertices[z * kBrickSide + y];
  return {static_cast<std::uint32_t>(first), row_crossings(owner.signs, y, z).packed};
}

// The row (y, z) of the next brick along x, with y and z = 0 .. 7. Only its first node is used,
// which is node 8 of the row here. The vertices of a node have numbers in the order x, y, z, so its
// crossing along z comes before no other and is left out. The signs of this brick tell its crossing
// along y; that along x needs one sign of the next brick.
__device__ VertexRow row_across_x(const BrickSigns& here, const ActiveBrick& next,
                                  std::uint32_t first, int y, int z) {
  const std::uint32_t own = static_cast<std::uint32_t>(here.row[z][y]) >> kBrickSide;
  const std::uint32_t behind = static_cast<std::uint32_t>(here.row[z][y + 1]) >> kBrickSide;
  const std::uint32_t along_x = (own ^ static_cast<std::uint32_t>(next.signs.row[z][y]) >> 1) & 1u;
  return {first + next.row_vertices[z * kBrickSide + y], along_x | (own ^ behind) << kBrickSide};
}

// Fills the rows of upper neighbours. The first warp fills the 17 rows of this brick with y or z
// equal to 8. If the surface crosses the face to the next brick along x, the second warp fills the
// same 17 rows of that brick, and each thread of both warps fills one of its 64 other rows.
template <Connectivity connectivity>
__device__ void share_rows_beyond(const BrickList& list, std::uint64_t before_mesh,
                                  std::uint32_t faces, TriangleShared<connectivity>& s) {
  constexpr int edge = 2 * kBrickReach - 1;
  const bool across_x = (faces & 2u) != 0;
  const auto thread = static_cast<int>(own_thread()), lane = thread % static_cast<int>(kWarp);
  const int dx = thread / static_cast<int>(kWarp);
  if (lane < edge && (dx == 0 || across_x)) {
    const int y = lane < kBrickReach ? kBrickSide : lane - kBrickReach;
    const int z = lane < kBrickReach ? lane : kBrickSide;
    s.rows[dx * kRows + z * kBrickReach + y] = row_beyond(list, before_mesh, s.near, dx, y, z);
  }
  const std::uint32_t next = s.near.place[upper_neighbour(1, 0, 0)];
  // check_neighbours() reports a missing neighbour.
  if (!across_x || next == kNoBrick) return;
  const auto first = static_cast<std::uint32_t>(list.before[next].vertices - before_mesh);
  const int y = thread % kBrickSide, z = thread / kBrickSide;
  s.rows[kRows + z * kBrickReach + y] = row_across_x(s.brick.signs, list.bricks[next], first, y, z);
}

// The mixed cells beyond a face, which are cells of the brick `owner`. They are entered in the
// shell with the coordinates of this brick, which differ from the owner's by 8 along the axis of
// the face.
struct CellsBeyond {
  const ActiveBrick& owner;
  int face;
};

// Enters those across x, lower or upper: by a warp, two cells a lane. Each is the first cell of its
// row, or the last, whose triangles end where the next row's begin.
template <int face>
__device__ void share_cells_across_x(const ActiveBrick& owner, const TriangleCodes& codes,
                                     CellShell<Connectivity::half_edges>& shell) {
  constexpr int x = face == 0 ? kBrickSide - 1 : 0, entered = face == 0 ? -1 : kBrickSide;
#pragma unroll
  for (int half = 0; half < 2; ++half) {
    const int row = static_cast<int>(threadIdx.x % kWarp) + half * static_cast<int>(kWarp);
    const int y = row % kBrickSide, z = row / kBrickSide;
    const std::uint32_t inside = cell_case(owner.signs, x, y, z), own = codes.count[inside];
    std::uint32_t start = owner.row_triangles[row];
    if constexpr (face == 0) {
      start = (row + 1 < kOwnRows ? owner.row_triangles[row + 1] : owner.triangles) - own;
    }
    if (own == 0) continue;
    shell.cell[shell_cell(entered, y, z)] = shell_word(inside, 3 * start, 1 + face);
  }
}

// Enters those of row (y, z) across y or z, by a lane. (cell_y, cell_z) is the row in the shell.
__device__ void share_row_of_cells(const CellsBeyond& beyond, int y, int z, int cell_y, int cell_z,
                                   const TriangleCodes& codes,
                                   CellShell<Connectivity::half_edges>& shell) {
  const ActiveBrick& owner = beyond.owner;
  // The four rows of nodes at the cells are loaded once.
  BrickSigns rows{};
  for (int i = 0; i < 4; ++i) rows.row[i / 2][i % 2] = owner.signs.row[z + i / 2][y + i % 2];
  std::uint32_t start = 3u * owner.row_triangles[z * kBrickSide + y];
  for (std::uint32_t cells = mixed_cells(rows, 0, 0); cells != 0; cells &= cells - 1) {
    const int x = __ffs(static_cast<int>(cells)) - 1;
    const std::uint32_t inside = cell_case(rows, x, 0, 0);
    shell.cell[shell_cell(x, cell_y, cell_z)] =
        shell_word(inside, start, 1 + static_cast<std::uint32_t>(beyond.face));
    start += 3 * codes.count[inside];
  }
}

// Checks, for the first 6 lanes of a warp and the faces of their numbers, that the list has the
// brick beyond each face that the surface crosses, and adds the missing ones to `missing`. A brick
// that only shares an edge with this one needs no check of its own: if the surface crosses that
// edge, it crosses the four faces at it. A brick between the two shares such a face with both. If
// it is in the list, its own check reports the missing brick; if not, this check reports it.
// `searched_from`: the search has left out all bricks with lower keys, which only lie across lower
// faces. Without half-edges nothing refers to them.
__device__ void check_neighbours(const TriangleNeighbours& near, std::uint32_t faces,
                                 std::uint64_t key, std::uint64_t searched_from,
                                 unsigned long long* missing) {
  const unsigned face = threadIdx.x % kWarp;
  if (face >= 6 || (faces >> face & 1u) == 0 ||
      near.place[neighbour_across(static_cast<int>(face))] != kNoBrick) {
    return;
  }
  const unsigned axis = face / 2;
  const std::uint64_t step = brick_key({axis == 0, axis == 1, axis == 2});
  const bool searched = face % 2 == 1 || key >= searched_from + step;
  if (searched) atomicAdd(missing, 1ull);
}

// For half-edges: enters the mixed cells beyond all faces that the surface crosses, and the numbers
// of the first half-edges of all bricks. The first warp has the faces across x, the second those
// across y and z: lane 8 (f - 2) + i has row i beyond face f. `before`: the triangles of the list
// before those of the brick; `before_mesh`: those before the brick's mesh.
__device__ void share_cells_beyond(const BrickList& list, std::uint64_t before,
                                   std::uint64_t before_mesh, const TriangleCodes& codes,
                                   std::uint32_t faces,
                                   TriangleShared<Connectivity::half_edges>& s) {
  const auto share_first = [&](int number, std::uint64_t triangles) {
    s.shell.first_half_edge[number] = 3 * static_cast<std::uint32_t>(triangles - before_mesh);
  };
  const auto lane = static_cast<int>(threadIdx.x % kWarp);
  if (own_half() == 0) {
    const std::uint32_t lower = s.near.place[neighbour_across(0)];
    const std::uint32_t upper = s.near.place[neighbour_across(1)];
    const bool has_lower = (faces & 1u) != 0 && lower != kNoBrick;
    const bool has_upper = (faces & 2u) != 0 && upper != kNoBrick;
    if (has_lower) share_cells_across_x<0>(list.bricks[lower], codes, s.shell);
    if (has_upper) share_cells_across_x<1>(list.bricks[upper], codes, s.shell);
    if (lane == 0) share_first(0, before);
    if (lane == 1 && has_lower) share_first(1, list.before[lower].triangles);
    if (lane == 2 && has_upper) share_first(2, list.before[upper].triangles);
    return;
  }
  const int face = 2 + lane / kBrickSide, along = lane % kBrickSide;
  const std::uint32_t place = s.near.place[neighbour_across(face)];
  if ((faces >> face & 1u) == 0 || place == kNoBrick) return;
  const bool lower = face % 2 == 0, across_y = face < 4;
  const int layer = lower ? kBrickSide - 1 : 0, entered = lower ? -1 : kBrickSide;
  share_row_of_cells({list.bricks[place], face}, across_y ? layer : along, across_y ? along : layer,
                     across_y ? entered : along, across_y ? along : entered, codes, s.shell);
  if (along == 0) share_first(1 + face, list.before[place].triangles);
}

// ---- triangles ----

// Number in the mesh of the vertex at which a half-edge of a cell starts: the first vertex of the
// node's row plus the number of crossed edges of the row before this one. `row` is the row 9 z + y
// and `column` 4 x of the cell's lower corner.
template <Connectivity connectivity>
__device__ std::uint32_t corner_number(const TriangleShared<connectivity>& s,
                                       const TriangleCodes& codes, const HalfEdgeCode& edge,
                                       unsigned row, unsigned column) {
  const unsigned at = column + edge.column();
  // Nodes x = 8 are in the second half of the rows.
  const VertexRow nodes = s.rows[row + edge.row() + (at >= 4 * kBrickSide ? kRows : 0)];
  return nodes.first + static_cast<std::uint32_t>(__popc(nodes.crossed & codes.before[at]));
}

// Number in the mesh of the opposite of a half-edge of the cell `cell` of the shell. If the
// opposite is in another cell, the code counts from kFirstFaceCode and names a place in the common
// face: the case of that cell then tells its half-edge there.
__device__ std::uint32_t opposite_number(const CellShell<Connectivity::half_edges>& shell,
                                         const TriangleCodes& codes, const HalfEdgeCode& edge,
                                         int cell) {
  const ShellCell there = shell.cell[cell + edge.step()];
  std::uint32_t half_edge = edge.opposite();
  if (half_edge >= kFirstFaceCode) {
    half_edge = codes.face_half_edge[there.inside()][half_edge - kFirstFaceCode];
  }
  return shell.first_half_edge[there.brick()] + there.half_edge() + half_edge;
}

// Writes `count` words, three of each lane, to consecutive places: they go through shared memory,
// so that consecutive lanes write consecutive words. All lanes of the warp call it. `staged` has
// room for the words of the warp, `to` is where the first word goes.
__device__ void store_staged(const std::uint32_t (&own)[3], std::uint32_t count,
                             std::uint32_t* staged, std::uint32_t* to) {
  const unsigned lane = threadIdx.x % kWarp;
  std::uint32_t* const in = staged + 3 * lane;
  const std::uint32_t* const out = staged + lane;
  std::uint32_t* const target = to + lane;
  // The lanes may still be reading the words of the call before.
  __syncwarp();
#pragma unroll
  for (unsigned k = 0; k < 3; ++k) in[k] = own[k];
  __syncwarp();
#pragma unroll
  for (unsigned k = 0; k < 3; ++k) {
    if (k * kWarp + lane < count) target[k * kWarp] = out[k * kWarp];
  }
}

// All bricks are of one mesh.
struct OneMesh {
  __device__ BrickSums before(std::uint64_t) const { return {0, 0}; }
};

// Each layer of bricks is of one mesh, and each mesh is numbered from 0.
struct StackedMeshes {
  const BrickSums* before_mesh;  // by layer: what the meshes before have

  __device__ BrickSums before(std::uint64_t key) const { return before_mesh[brick_of_key(key).z]; }
};

// Writes the corners of the triangles of bricks and, if half-edges are asked for, the opposite
// half-edges: of the `size` bricks from brick `first` of the list on, each by a group of two warps.
// The warps take the triangles in turns, 32 at a time, a lane for each. Half-edge n of the brick
// goes to index 3 * (number of the brick's first triangle - mesh.first_triangle) + n. Dynamic
// shared memory: a TriangleBlock, without the groups that the block lacks.
template <Connectivity connectivity, class Meshes>
__global__ void __launch_bounds__(kMostGroups* kGroupThreads, kBlocksPerProcessor)
    emit_triangles(BrickList list, Meshes meshes, std::uint32_t first, std::uint32_t size,
                   const TriangleNeighbours* neighbours, std::uint64_t searched_from,
                   const TriangleCodes* global_codes, DeviceMeshView mesh,
                   unsigned long long* missing) {
  extern __shared__ __align__(16) unsigned char dynamic[];
  auto& block = *reinterpret_cast<TriangleBlock<connectivity>*>(dynamic);
  constexpr bool half_edges = connectivity == Connectivity::half_edges;
  const TriangleCodes& codes = block.codes;
  share_codes(*global_codes, block.codes);
  TriangleShared<connectivity>& s = block.group[own_group()];
  __syncthreads();
  const unsigned lane = threadIdx.x % kWarp, warp = own_half();
  const unsigned groups = blockDim.x / kGroupThreads;
  for (std::uint32_t at = blockIdx.x * groups + own_group(); at < size; at += gridDim.x * groups) {
    const LoadedBrick loaded(list, neighbours, first + at);
    const BrickSums before = loaded.before;
    if (loaded.after == before.triangles) continue;
    // The other warp may still be at the brick before.
    sync_group();
    loaded.share(s.brick, s.near);
    const std::uint32_t words =
        static_cast<std::uint32_t>(loaded.after - before.triangles) / kWarp + 3;
#pragma unroll 1
    for (unsigned w = own_thread(); w < words; w += kGroupThreads) s.begins[w] = 0;
    if (own_thread() == 0) s.face_signs = 0;
    sync_group();
    const BrickSums before_mesh = meshes.before(s.brick.key);
    share_cells(codes, s);
    share_own_rows(before.vertices - before_mesh.vertices, s);
    share_face_signs(s);
    sync_group();
    const std::uint32_t faces = faces_crossed(s.face_signs);
    share_rows_beyond(list, before_mesh.vertices, faces, s);
    if (warp == 0) check_neighbours(s.near, faces, s.brick.key, searched_from, missing);
    if constexpr (half_edges) {
      share_cells_beyond(list, before.triangles, before_mesh.triangles, codes, faces, s);
    }
    sync_group();

    const std::uint64_t place = 3 * (before.triangles - mesh.first_triangle);
    // `cells`: the number of cells that begin before the word's triangles.
    auto cells = warp == 0 ? 0u : static_cast<std::uint32_t>(__popc(s.begins[0]));
    for (std::uint32_t w = warp; w * kWarp < s.brick.triangles; w += kGroupThreads / kWarp) {
      const std::uint32_t left = s.brick.triangles - w * kWarp, count = left < kWarp ? left : kWarp;
      // Lanes without a triangle repeat the last one.
      const std::uint32_t t = lane < count ? lane : count - 1, word = s.begins[w];
      // The triangle's cell is the last one that begins at it or before it.
      const auto rank = static_cast<std::uint32_t>(__popc(word & ((2u << t) - 1)));
      const MixedCell mixed = s.cells[cells + rank - 1];
      cells += static_cast<std::uint32_t>(__popc(word) + __popc(s.begins[w + 1]));
      const TriangleCode code = codes.triangle[mixed.inside()][w * kWarp + t - mixed.start()];
      const unsigned x = mixed.cell() % kBrickSide, y = mixed.cell() / kBrickSide % kBrickSide;
      const unsigned z = mixed.cell() / kCellsPerFace;
      std::uint32_t corners[3], opposite[3];
      for (int k = 0; k < 3; ++k) {
        const HalfEdgeCode edge = code.half_edge(k);
        corners[k] = corner_number(s, codes, edge, z * kBrickReach + y, 4 * x);
        if constexpr (half_edges) {
          const int cell =
              shell_cell(static_cast<int>(x), static_cast<int>(y), static_cast<int>(z));
          opposite[k] = opposite_number(s.shell, codes, edge, cell);
        }
      }
      const std::uint64_t to = place + 3 * w * kWarp;
      store_staged(corners, 3 * count, s.staged[warp], mesh.corners + to);
      if constexpr (half_edges) {
        store_staged(opposite, 3 * count, s.staged[warp], mesh.opposite + to);
      }
    }
  }
}

}  // namespace

void emit_triangles_on_device(const BrickList& bricks,
                              const DeviceArray<TriangleNeighbours>& neighbours,
                              std::uint64_t searched_from, const BrickSums* before_mesh,
                              const BrickRange& range, const DeviceMeshView& mesh,
                              DeviceEmissionTally* tally, const Stream& stream) {
  const auto launch_as = [&]<Connectivity connectivity, class Meshes>(const Meshes& meshes) {
    const auto kernel = emit_triangles<connectivity, Meshes>;
    // Few bricks are spread over all multiprocessors, by blocks of fewer groups.
    const unsigned blocks = kBlocksPerProcessor * multiprocessors();
    const unsigned groups = std::clamp(blocks_for(range.size(), blocks), 1u, kMostGroups);
    LaunchShape shape = over(range.size(), groups, groups * kGroupThreads);
    shape.blocks.x = std::min(shape.blocks.x, blocks);
    shape.shared = sizeof(TriangleBlock<connectivity>) -
                   (kMostGroups - groups) * sizeof(TriangleShared<connectivity>);
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                    static_cast<int>(sizeof(TriangleBlock<connectivity>))),
               "shared memory");
    launch("emit_triangles", kernel, shape, stream, bricks, meshes,
           static_cast<std::uint32_t>(range.begin), static_cast<std::uint32_t>(range.size()),
           neighbours.data(), searched_from, triangle_codes_on_device(), mesh,
           &tally->missing_neighbours);
  };
  const auto emit = [&]<class Meshes>(const Meshes& meshes) {
    if (mesh.opposite != nullptr) {
      launch_as.template operator()<Connectivity::half_edges>(meshes);
    } else {
      launch_as.template operator()<Connectivity::triangles>(meshes);
    }
  };
  if (before_mesh == nullptr) {
    emit(OneMesh{});
  } else {
    emit(StackedMeshes{before_mesh});
  }
}

}  // namespace vdwmesh
