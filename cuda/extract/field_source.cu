// Marching cubes over a field that is given by its values at the nodes, in device memory: for
// FieldMesher::mesh_into(). A node is inside if its value is at least the isovalue, and its sign is
// one bit.
// 1. pack_signs reads the whole field once and writes a sign bit per node.
// 2. find_mixed looks at the bits and marks the bricks of the range that have nodes of both signs.
// 3. A stream compaction makes the list of candidate bricks from the marks. Unlike the candidates
//    of fields over spheres, each of them holds surface.
// 4. count_sampled counts them; DeviceBrickMesher numbers and emits them as for any field.
// Values are read again only for the vertices: at the ends of crossed edges and, for normals,
// around them.
#include <algorithm>
#include <string>

#include "cuda/extract/bricks/brick_warp.cuh"
#include "cuda/extract/bricks/marked_bricks.cuh"
#include "cuda/extract/field_source.cuh"
#include "cuda/memory/launch.cuh"
#include "extract/blended/sampled_formulas.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 256;
constexpr int kBricksPerWord = 4;  // a word has the signs of 32 nodes, 8 of each brick

SignGrid sign_grid(const GridSpec& grid) {
  SignGrid g{};
  for (int axis = 0; axis < 3; ++axis) g.bricks[axis] = brick_count(grid.cells[axis]);
  g.words = (g.bricks[0] + kBricksPerWord - 1) / kBricksPerWord;
  g.height = grid.cells.y + 1;
  g.depth = grid.cells.z + 1;
  return g;
}

// Writes the sign words of the rows of nodes (SignGrid says how nodes and bits are numbered). A
// warp per row, 8 rows per thread block. One ballot makes a word from 32 values. A warp reads eight
// words' values before the first ballot, to keep enough reads in flight. Node i of the grid has
// lattice index i + 1, so the words are shifted up by one bit; the top bit of a word becomes the
// lowest bit of the next. The shift comes after the ballot, so that reads begin at the first value
// of the row.
__global__ void __launch_bounds__(kThreads)
    pack_signs(SampledFieldView field, SignGrid grid, std::uint32_t* words) {
  constexpr int at_once = 8;
  const unsigned lane = threadIdx.x % kWarp;
  const std::int64_t row = (static_cast<std::int64_t>(blockIdx.x) * kThreads + threadIdx.x) / kWarp;
  if (row >= grid.height * grid.depth) return;
  const std::int64_t width = field.grid.cells.x + 1;
  const float* const values = field.values + row * width;
  std::uint32_t before = 0;  // the last unshifted word of the turn before
  for (std::int64_t first = 0; first < grid.words; first += at_once) {
    float value[at_once];
#pragma unroll
    for (int w = 0; w < at_once; ++w) {
      const std::int64_t node = kWarp * (first + w) + lane;
      // Beyond the row: NaN. Comparisons with it are false, so the node is outside.
      value[w] = node < width ? __ldcs(values + node) : __int_as_float(0x7fc00000);
    }
    std::uint32_t own = 0;
#pragma unroll
    for (int w = 0; w < at_once; ++w) {
      const std::uint32_t word = __ballot_sync(kAllLanes, value[w] >= field.isovalue);
      // The ballot gives word w to all lanes; lane w keeps it.
      if (lane == static_cast<unsigned>(w)) own = word;
    }
    // The funnel shift moves the word of the lane up by one, and the top bit of the word before it
    // in.
    const std::uint32_t lower = __shfl_up_sync(kAllLanes, own, 1);
    const std::uint32_t moved = __funnelshift_l(lane == 0 ? before : lower, own, 1);
    before = __shfl_sync(kAllLanes, own, at_once - 1);
    if (lane < at_once && first + lane < grid.words) words[row * grid.words + first + lane] = moved;
  }
}

// Writes to `mixed`, for every brick, whether it is in the range and its 9 x 9 x 9 nodes are of
// both signs. A thread handles the four bricks of one word along x and of one brick index along y
// and z; 2 KB of shared memory. It reads the words of the 9 x 9 rows that the bricks' cells touch.
// Bit i of `any` says whether node i is inside in some row, bit i of `all` whether in every row.
// The ninth node along x of the fourth brick is in the next thread's word, so both words are
// exchanged in shared memory. The last thread of a block only provides its words; blocks overlap by
// this thread.
__global__ void __launch_bounds__(kThreads)
    find_mixed(SignGrid grid, const std::uint32_t* words, KeyRange range, std::uint8_t* mixed) {
  __shared__ std::uint32_t any_next[kThreads], all_next[kThreads];
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * (kThreads - 1) + threadIdx.x;
  const std::int64_t w = i % grid.words, by = i / grid.words % grid.bricks[1];
  const std::int64_t bz = i / grid.words / grid.bricks[1];
  std::uint32_t any = 0, all = bz < grid.bricks[2] ? ~0u : 0u;
  for (int z = 0; z < kBrickReach && bz < grid.bricks[2]; ++z) {
    const std::int64_t node_z = bz * kBrickSide + z - 1;
#pragma unroll
    for (int y = 0; y < kBrickReach; ++y) {
      const std::int64_t node_y = by * kBrickSide + y - 1;
      const bool real = node_z >= 0 && node_z < grid.depth && node_y >= 0 && node_y < grid.height;
      const std::uint32_t word =
          real ? words[(node_z * grid.height + node_y) * grid.words + w] : 0u;
      any |= word;
      all &= word;
    }
  }
  any_next[threadIdx.x] = any;
  all_next[threadIdx.x] = all;
  __syncthreads();
  if (threadIdx.x == kThreads - 1 || bz >= grid.bricks[2]) return;
  const bool last = w + 1 == grid.words;
  const std::uint64_t any_bits =
      any | static_cast<std::uint64_t>(last ? 0 : any_next[threadIdx.x + 1]) << 32;
  const std::uint64_t all_bits =
      all | static_cast<std::uint64_t>(last ? 0 : all_next[threadIdx.x + 1]) << 32;
  // Nine bits, nodes 0 .. 8 of a brick, at bit 8 b for brick b. Bit 32 is from the next word.
  constexpr std::uint64_t nodes = (1u << kBrickReach) - 1;
  for (int b = 0; b < kBricksPerWord; ++b) {
    const std::int64_t bx = w * kBricksPerWord + b;
    if (bx >= grid.bricks[0]) return;
    const bool some = (any_bits >> (kBrickSide * b) & nodes) != 0;
    const bool full = (all_bits >> (kBrickSide * b) & nodes) == nodes;
    const std::uint64_t key =
        brick_key({static_cast<std::int32_t>(bx), static_cast<std::int32_t>(by),
                   static_cast<std::int32_t>(bz)});
    const bool wanted = key >= range.begin && key < range.end;
    mixed[(bz * grid.bricks[1] + by) * grid.bricks[0] + bx] = some && !full && wanted ? 1 : 0;
  }
}

// Keys, rising, of the bricks of the range whose nodes are of both signs. Throws LimitExceeded if
// they are more than `most`.
KeyList mixed_bricks(const SignGrid& grid, const std::uint32_t* words, const KeyRange& range,
                     std::uint64_t most, const Stream& stream) {
  const auto bricks = static_cast<std::size_t>(grid.brick_total());
  const DeviceArray<std::uint8_t> mixed(bricks, stream.get());
  const std::int64_t row_words = grid.words * grid.bricks[1] * grid.bricks[2];
  launch("find_mixed", find_mixed,
         over(static_cast<std::uint64_t>(row_words), kThreads - 1, kThreads), stream, grid, words,
         range, mixed.data());
  KeyList result = keys_of_marks(mixed.data(), grid.bricks, bricks, stream);
  if (result.count > most) {
    throw LimitExceeded("the surface crosses " + std::to_string(result.count) +
                        " bricks of 8 x 8 x 8 nodes; at most " + std::to_string(most) +
                        " fit in the memory allowed");
  }
  return result;
}

// Shares the signs of a brick, whose virtual nodes `g` knows. By a warp. Rows of virtual nodes are
// not stored, and their signs are 0. If the brick is the last of its word, node 8 is in the next
// word.
__device__ void share_signs_of(const SignGrid& grid, const std::uint32_t* words,
                               const BrickGeometry& g, BrickSigns& signs) {
  const std::int64_t w = g.brick.x / kBricksPerWord, layer = grid.height * grid.words;
  const int shift = g.brick.x % kBricksPerWord * kBrickSide;
  const bool in_next = shift + kBrickSide == 32 && w + 1 < grid.words;
  // The index of the word in the row of node 0. A lattice index is one above a grid index.
  const std::int64_t first = (lattice_index(g.brick.z, 0) - 1) * layer +
                             (lattice_index(g.brick.y, 0) - 1) * grid.words + w;
  const std::uint32_t real_y = g.real[1], real_z = g.real[2];
#pragma unroll
  for (unsigned turn = 0; turn < (kRows + kWarp - 1) / kWarp; ++turn) {
    const unsigned row = turn * kWarp + threadIdx.x % kWarp;
    if (row >= kRows) break;
    const unsigned y = row % kBrickReach, z = row / kBrickReach;
    std::uint32_t bits = 0;
    if ((real_y >> y & real_z >> z & 1u) != 0) {
      const std::uint32_t* const word = words + first + y * grid.words + z * layer;
      bits = *word >> shift;
      if (in_next) bits |= word[1] << kBrickSide;
    }
    signs.row[z][y] = static_cast<std::uint16_t>(bits & ((1u << kBrickReach) - 1));
  }
}

// Counts candidate bricks: writes bricks[i] and the counts of brick i, which has the key keys[i].
// A warp per brick, 2 warps per thread block; about 1.4 KB of shared memory.
__global__ void __launch_bounds__(kBrickThreads)
    count_sampled(GridSpec spec, SignGrid grid, const std::uint32_t* words,
                  const std::uint64_t* keys, std::uint64_t size, const CaseTable* table,
                  ActiveBrick* bricks, BrickCounts counts) {
  __shared__ ActiveBrick shared[kBrickWarps];
  __shared__ BrickGeometry geometry[kBrickWarps];
  const unsigned warp = threadIdx.x / kWarp, lane = threadIdx.x % kWarp;
  const std::uint64_t i = static_cast<std::uint64_t>(blockIdx.x) * kBrickWarps + warp;
  if (i >= size) return;
  const std::uint64_t key = keys[i];
  ActiveBrick& brick = shared[warp];
  if (lane == 0) brick.key = key;
  share_geometry<NodeCoordinates::left_out>(spec, key, geometry[warp]);
  share_signs_of(grid, words, geometry[warp], brick.signs);
  __syncwarp();
  count_brick(geometry[warp], *table, brick);
  __syncwarp();
  store_count(brick, i, bricks, counts);
}

}  // namespace

FieldSource::FieldSource(const SampledFieldView& field, const ExtractOptions& options,
                         const Stream& stream)
    : BrickSource(stream), field_(field), signs_(sign_grid(field.grid)) {
  // The sign words, and for candidates() 9 bytes per brick: its mark and its key.
  require_device_memory(static_cast<std::uint64_t>(signs_.size()) * sizeof(std::uint32_t) +
                            static_cast<std::uint64_t>(signs_.brick_total()) * 9,
                        "a bit per node", options.device_memory);
  words_ = DeviceArray<std::uint32_t>(static_cast<std::size_t>(signs_.size()), stream.get());
  const auto rows = static_cast<std::uint64_t>(signs_.height * signs_.depth);
  launch("pack_signs", pack_signs, over(rows * kWarp, kThreads), stream, field_, signs_,
         words_.data());
}

KeyList FieldSource::candidates(const KeyRange& range, std::uint64_t most) const {
  return mixed_bricks(signs_, words_.data(), range, most, stream());
}

void FieldSource::count(const std::uint64_t* keys, std::uint64_t size, ActiveBrick* bricks, void*,
                        const BrickCounts& counts) const {
  launch("count_sampled", count_sampled, over(size, kBrickWarps, kBrickThreads), stream(),
         field_.grid, signs_, words_.data(), keys, size, case_table_on_device(), bricks, counts);
}

void FieldSource::emit_vertices(const BrickList& bricks, std::uint32_t, const void*,
                                const DeviceMeshView& mesh, unsigned long long* clamped) const {
  emit_sampled_vertices_on_device(field_, bricks, mesh, clamped, stream());
}

}  // namespace vdwmesh
