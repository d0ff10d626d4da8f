// A blended field at every node of a grid: a block of threads for 2 x 2 x 2 bricks, which share the
// atoms near them and their terms; a warp per brick, two rows of nodes a lane.
#include "cuda/brick_block.cuh"
#include "extract/local_atom.hpp"

namespace vdwmesh {
namespace {

constexpr int kBlockSide = 2 * kBrickSide;
constexpr unsigned kBlockBricks = 8;
constexpr unsigned kBlockThreads = kBlockBricks * kWarp;
constexpr std::uint32_t kBlockAtoms = 64;  // in shared memory at a time
constexpr std::uint32_t kPlaces = 1024;    // gathered at a time

struct alignas(16) BlockAtom {
  AxisTerm term[3][kBlockSide];
};

struct BlockShared {
  GatherState gather;
  std::int64_t first[3];  // lattice indices of node 0
  double coordinate[3][kBlockSide];
  std::uint32_t places[kPlaces];
  float center[3][kBlockAtoms];  // Å, from the block's node 0
  float reach_square[kBlockAtoms];
  float scale[kBlockAtoms];
  union {
    BlockAtom atoms[kBlockAtoms];
    float values[kBlockSide][kBlockSide][kBlockSide];
  };
};

__host__ __device__ std::int64_t blocks_along(std::int64_t cells) {
  return (brick_count(cells) + 1) / 2;
}

__device__ void share_block(const GridSpec& grid, BlockShared& s) {
  const std::int64_t width = blocks_along(grid.cells.x), height = blocks_along(grid.cells.y);
  const std::int64_t block[3] = {blockIdx.x % width, blockIdx.x / width % height,
                                 blockIdx.x / width / height};
  if (threadIdx.x < 3) s.first[threadIdx.x] = block[threadIdx.x] * kBlockSide;
  const auto i = static_cast<int>(threadIdx.x) % kBlockSide;
  const auto axis = static_cast<int>(threadIdx.x) / kBlockSide;
  if (axis < 3) {
    const std::int64_t lattice = block[axis] * kBlockSide + i;
    s.coordinate[axis][i] = lattice_coordinate(grid, axis, lattice);
  }
  __syncthreads();
}

// Terms of the gathered atoms; leaves the block synchronised.
template <FieldKind kind>
__device__ void share_block_atoms(const FieldContext& f, const NodeShape& nodes,
                                  const std::uint32_t* places, std::uint32_t count,
                                  BlockShared& s) {
  if (threadIdx.x < count) {
    const Sphere& atom = f.list.spheres[places[threadIdx.x]];
    const double scale = inverse_square_scale(f.model, atom.radius);
    const double reach = field_reach(f.model, atom.radius);
    const bool subgrid = f.model.truncation == Truncation::subgrid;
    s.scale[threadIdx.x] = static_cast<float>(scale);
    s.reach_square[threadIdx.x] = subgrid ? 1e30f : static_cast<float>(reach * reach * (1 + 1e-5));
    for (int axis = 0; axis < 3; ++axis) {
      s.center[axis][threadIdx.x] = static_cast<float>(atom.center[axis] - s.coordinate[axis][0]);
    }
  }
  __syncthreads();
  // A thread keeps to one plane of nodes, atom after atom.
  constexpr unsigned terms = 3 * kBlockSide, at_once = kBlockThreads / terms;
  const auto axis = static_cast<int>(threadIdx.x % terms) / kBlockSide;
  const auto node = static_cast<int>(threadIdx.x % terms) % kBlockSide;
  const std::int64_t lattice = s.first[axis] + node;
  const double coordinate = s.coordinate[axis][node];
  for (std::uint32_t k = threadIdx.x / terms; k < count && threadIdx.x < at_once * terms;
       k += at_once) {
    s.atoms[k].term[axis][node] = lattice_term<kind>(f.model, nodes, f.list.spheres[places[k]],
                                                     s.scale[k], axis, lattice, coordinate);
  }
  __syncthreads();
}

// A brick of the block: its first node, and where its nodes end, Å from the block's node 0.
struct OwnBrick {
  int node[3];
  float lower[3], upper[3];
};

__device__ OwnBrick own_brick(const GridSpec& grid) {
  const auto warp = static_cast<int>(threadIdx.x / kWarp);
  OwnBrick b{
      {(warp & 1) * kBrickSide, (warp >> 1 & 1) * kBrickSide, (warp >> 2) * kBrickSide}, {}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    b.lower[axis] = static_cast<float>(b.node[axis] * grid.spacing);
    b.upper[axis] = static_cast<float>((b.node[axis] + kBrickSide - 1) * grid.spacing);
  }
  return b;
}

// Bit k: the atom first + k may add to the brick. By all lanes of its warp.
__device__ unsigned atoms_in_reach(const BlockShared& s, const OwnBrick& b, std::uint32_t count,
                                   std::uint32_t first) {
  const std::uint32_t k = first + threadIdx.x % kWarp;
  bool reaches = false;
  if (k < count) {
    float d2 = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float c = s.center[axis][k];
      const float d = fmaxf(fmaxf(b.lower[axis] - c, c - b.upper[axis]), 0.0f);
      d2 = fmaf(d, d, d2);
    }
    // Beyond the rounding of the distance, the atom adds exactly 0.
    reaches = d2 <= s.reach_square[k];
  }
  return __ballot_sync(kAllLanes, reaches);
}

template <FieldKind kind>
__device__ void add_to_row(const NodeShape& nodes, const BlockShared& s, std::uint32_t k,
                           const AxisTerm* along, const AxisTerm& y, const AxisTerm& z,
                           float (&row)[kBrickSide]) {
  const RowTerm term = row_term<kind>(nodes, y, z);
  if (row_is_out_of_reach<kind>(nodes, term)) return;
#pragma unroll
  for (int x = 0; x < kBrickSide; ++x) {
    row[x] = add_atom<kind>(nodes, term, along[x], s.scale[k], row[x]);
  }
}

// Writes the nodes that the grid has, a plane of the block at a time.
__device__ void store_block(const GridSpec& grid, const BlockShared& s, float* values) {
  static_assert(kBlockThreads == kBlockSide * kBlockSide);
  const auto x = static_cast<int>(threadIdx.x) % kBlockSide;
  const auto y = static_cast<int>(threadIdx.x) / kBlockSide;
  const std::int64_t nx = s.first[0] + x - 1, ny = s.first[1] + y - 1, nz = s.first[2] - 1;
  const std::int64_t width = grid.cells.x + 1, height = grid.cells.y + 1;
  if (nx < 0 || ny < 0 || nx >= width || ny >= height) return;
  float* out = values + (nz * height + ny) * width + nx;
  const int begin = nz < 0 ? 1 : 0;
  const std::int64_t above = grid.cells.z + 1 - nz;
  const int end = above < kBlockSide ? static_cast<int>(above) : kBlockSide;
  for (int z = begin; z < end; ++z) out[z * width * height] = s.values[z][y][x];
}

// The rows (y, z) and (y, z + 4) of a lane's brick.
struct RowPair {
  int y, z;
  float low[kBrickSide] = {}, high[kBrickSide] = {};
};
constexpr int kRowsApart = kBrickSide / 2;

__device__ RowPair own_rows(const OwnBrick& brick) {
  const auto lane = static_cast<int>(threadIdx.x % kWarp);
  return {brick.node[1] + lane % kBrickSide, brick.node[2] + lane / kBrickSide};
}

// Adds the first `count` atoms in shared memory, in their order.
template <FieldKind kind>
__device__ void add_atoms(const NodeShape& nodes, const BlockShared& s, std::uint32_t count,
                          const OwnBrick& brick, RowPair& rows) {
  for (std::uint32_t first = 0; first < count; first += kWarp) {
    for (unsigned mask = atoms_in_reach(s, brick, count, first); mask != 0; mask &= mask - 1) {
      const std::uint32_t k = first + static_cast<std::uint32_t>(__ffs(static_cast<int>(mask))) - 1;
      const AxisTerm* const along = &s.atoms[k].term[0][brick.node[0]];
      const AxisTerm y = s.atoms[k].term[1][rows.y];
      add_to_row<kind>(nodes, s, k, along, y, s.atoms[k].term[2][rows.z], rows.low);
      add_to_row<kind>(nodes, s, k, along, y, s.atoms[k].term[2][rows.z + kRowsApart], rows.high);
    }
  }
}

template <FieldKind kind>
__global__ void __launch_bounds__(kBlockThreads, 4) sample_blocks(FieldContext f, float* values) {
  extern __shared__ __align__(16) unsigned char dynamic[];
  BlockShared& s = *reinterpret_cast<BlockShared*>(dynamic);
  const NodeShape nodes = node_shape(f.model);
  share_block(f.model.grid, s);
  constexpr int end = kBlockSide - 1;
  const Vec3d lower{s.coordinate[0][0], s.coordinate[1][0], s.coordinate[2][0]};
  const Vec3d upper{s.coordinate[0][end], s.coordinate[1][end], s.coordinate[2][end]};
  begin_gather(f.list, lower, upper, s.gather);
  const OwnBrick brick = own_brick(f.model.grid);
  RowPair rows = own_rows(brick);
  do {
    next_chunk(f.list, s.gather, s.places, kPlaces, [&](std::uint32_t place) {
      return reaches_box(f.model, lower, upper, f.list.spheres[place]);
    });
    for (std::uint32_t first = 0; first < s.gather.gathered; first += kBlockAtoms) {
      const std::uint32_t left = s.gather.gathered - first;
      const std::uint32_t count = left < kBlockAtoms ? left : kBlockAtoms;
      share_block_atoms<kind>(f, nodes, s.places + first, count, s);
      add_atoms<kind>(nodes, s, count, brick, rows);
      __syncthreads();
    }
  } while (!s.gather.finished);
  for (int x = 0; x < kBrickSide; ++x) {
    s.values[rows.z][rows.y][brick.node[0] + x] = rows.low[x];
    s.values[rows.z + kRowsApart][rows.y][brick.node[0] + x] = rows.high[x];
  }
  __syncthreads();
  store_block(f.model.grid, s, values);
}

using SampleKernel = void (*)(FieldContext, float*);

SampleKernel kernel_of(FieldKind kind) {
  if (kind == FieldKind::blinn) return sample_blocks<FieldKind::blinn>;
  if (kind == FieldKind::soft_object) return sample_blocks<FieldKind::soft_object>;
  return sample_blocks<FieldKind::inverse_squared>;
}

}  // namespace

void sample_field_on_device(const CellListView& list, const FieldModel& model, float* values,
                            const Stream& stream) {
  const SampleKernel kernel = kernel_of(model.kind);
  const Vec3i& cells = model.grid.cells;
  check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                  static_cast<int>(sizeof(BlockShared))),
             "shared memory");
  const std::int64_t blocks = blocks_along(cells.x) * blocks_along(cells.y) * blocks_along(cells.z);
  kernel<<<static_cast<unsigned>(blocks), kBlockThreads, sizeof(BlockShared), stream.get()>>>(
      {list, model}, values);
  check_launch("sample_blocks");
}

}  // namespace vdwmesh
