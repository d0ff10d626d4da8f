// A blended field at every node of a grid: a warp per brick, two rows of nodes a lane.
#include "cuda/brick_warp.cuh"
#include "extract/local_atom.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kBlockBricks = 4;  // side by side, so that they write whole lines together
constexpr unsigned kBlockThreads = kBlockBricks * kWarp;
constexpr std::uint32_t kAtomChunk = 16;  // in shared memory at a time
constexpr int kRowsApart = kBrickSide / 2;

struct SampleAtom {
  alignas(16) AxisTerm term[3][kBrickSide];
};

struct SampleShared {
  std::int64_t first[3];  // lattice indices of node 0
  double coordinate[3][kBrickSide];
  std::uint32_t waiting[kAtomChunk + kWarp];  // places of atoms that reach the brick
  Sphere spheres[kAtomChunk];
  float scale[kAtomChunk];
  union {
    SampleAtom atoms[kAtomChunk];
    float values[kOwnRows][kBrickSide];
  };
};

// Bricks along the axes, those of a block one after the other along x.
struct BrickGrid {
  std::int32_t width, height, depth;

  __host__ __device__ explicit BrickGrid(const GridSpec& grid)
      : width((brick_count(grid.cells.x) + static_cast<int>(kBlockBricks) - 1) /
              static_cast<int>(kBlockBricks) * static_cast<int>(kBlockBricks)),
        height(brick_count(grid.cells.y)),
        depth(brick_count(grid.cells.z)) {}
  __host__ __device__ std::int64_t blocks() const {
    return static_cast<std::int64_t>(width) * height * depth / kBlockBricks;
  }
};

// By one warp, which it leaves synchronised.
__device__ void share_nodes(const GridSpec& grid, SampleShared& s) {
  const BrickGrid bricks(grid);
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * kBlockBricks + threadIdx.x / kWarp;
  const std::int64_t brick[3] = {i % bricks.width, i / bricks.width % bricks.height,
                                 i / bricks.width / bricks.height};
  const auto lane = static_cast<int>(threadIdx.x % kWarp);
  const int axis = lane / kBrickSide, node = lane % kBrickSide;
  if (axis < 3) {
    const std::int64_t lattice = brick[axis] * kBrickSide + node;
    if (node == 0) s.first[axis] = lattice;
    s.coordinate[axis][node] = lattice_coordinate(grid, axis, lattice);
  }
  __syncwarp();
}

// Terms of the first `count` waiting atoms, all lanes at work; leaves the warp synchronised.
template <FieldKind kind>
__device__ void share_terms(const FieldContext& f, const NodeShape& nodes, std::uint32_t count,
                            SampleShared& s) {
  const unsigned lane = threadIdx.x % kWarp;
  if (lane < count) {
    s.spheres[lane] = f.list.spheres[s.waiting[lane]];
    s.scale[lane] = static_cast<float>(inverse_square_scale(f.model, s.spheres[lane].radius));
  }
  __syncwarp();
  constexpr unsigned terms = 3 * kBrickSide;
  for (unsigned i = lane; i < count * terms; i += kWarp) {
    const unsigned k = i / terms;
    const auto axis = static_cast<int>(i % terms) / kBrickSide;
    const auto node = static_cast<int>(i % terms) % kBrickSide;
    s.atoms[k].term[axis][node] =
        lattice_term<kind>(f.model, nodes, s.spheres[k], s.scale[k], axis, s.first[axis] + node,
                           s.coordinate[axis][node]);
  }
  __syncwarp();
}

// The rows (y, z) and (y, z + kRowsApart) of a lane.
struct RowPair {
  int y, z;
  float low[kBrickSide] = {}, high[kBrickSide] = {};
};

// Adds an atom to a row, where it reaches that of any lane.
template <FieldKind kind>
__device__ void add_to_row(const NodeShape& nodes, const SampleAtom& atom, float scale,
                           const RowTerm& term, float (&row)[kBrickSide]) {
  if (__all_sync(kAllLanes, row_is_out_of_reach<kind>(nodes, term))) return;
  const auto* const pairs = reinterpret_cast<const float4*>(atom.term[0]);
#pragma unroll
  for (int x = 0; x < kBrickSide; x += 2) {
    const float4 pair = pairs[x / 2];
    row[x] = add_atom<kind>(nodes, term, {pair.x, pair.y}, scale, row[x]);
    row[x + 1] = add_atom<kind>(nodes, term, {pair.z, pair.w}, scale, row[x + 1]);
  }
}

template <FieldKind kind>
__device__ void add_atoms(const NodeShape& nodes, const SampleShared& s, std::uint32_t count,
                          RowPair& rows) {
  for (std::uint32_t k = 0; k < count; ++k) {
    const SampleAtom& atom = s.atoms[k];
    const AxisTerm y = atom.term[1][rows.y];
    const RowTerm low = row_term<kind>(nodes, y, atom.term[2][rows.z]);
    const RowTerm high = row_term<kind>(nodes, y, atom.term[2][rows.z + kRowsApart]);
    add_to_row<kind>(nodes, atom, s.scale[k], low, rows.low);
    add_to_row<kind>(nodes, atom, s.scale[k], high, rows.high);
  }
}

// Writes the nodes that the grid has, four rows at a time.
__device__ void store_rows(const GridSpec& grid, const RowPair& rows, SampleShared& s,
                           float* values) {
  __syncwarp();
  const int low = rows.z * kBrickSide + rows.y, high = low + kRowsApart * kBrickSide;
#pragma unroll
  for (int x = 0; x < kBrickSide; ++x) {
    s.values[low][x] = rows.low[x];
    s.values[high][x] = rows.high[x];
  }
  __syncwarp();
  const auto lane = static_cast<int>(threadIdx.x % kWarp);
  const std::int64_t width = grid.cells.x + 1, height = grid.cells.y + 1;
  const std::int64_t nx = s.first[0] + lane % kBrickSide - 1;
  if (nx < 0 || nx >= width) return;
#pragma unroll 4
  for (int row = lane / kBrickSide; row < kOwnRows; row += static_cast<int>(kWarp) / kBrickSide) {
    const std::int64_t ny = s.first[1] + row % kBrickSide - 1;
    const std::int64_t nz = s.first[2] + row / kBrickSide - 1;
    if (ny < 0 || ny >= height || nz < 0 || nz > grid.cells.z) continue;
    values[(nz * height + ny) * width + nx] = s.values[row][lane % kBrickSide];
  }
}

template <FieldKind kind>
__global__ void __launch_bounds__(kBlockThreads, 8)
    sample_bricks(const __grid_constant__ FieldContext f, float* values) {
  __shared__ SampleShared shared[kBlockBricks];
  SampleShared& s = shared[threadIdx.x / kWarp];
  const NodeShape nodes = node_shape(f.model);
  share_nodes(f.model.grid, s);
  constexpr int end = kBrickSide - 1;
  const Vec3d lower{s.coordinate[0][0], s.coordinate[1][0], s.coordinate[2][0]};
  const Vec3d upper{s.coordinate[0][end], s.coordinate[1][end], s.coordinate[2][end]};
  const auto lane = static_cast<int>(threadIdx.x % kWarp);
  RowPair rows{lane % kBrickSide, lane / kBrickSide};
  gather_by_warp(f, lower, upper, s.waiting, kAtomChunk, [&](std::uint32_t count) {
    share_terms<kind>(f, nodes, count, s);
    add_atoms<kind>(nodes, s, count, rows);
    return false;
  });
  store_rows(f.model.grid, rows, s, values);
}

using SampleKernel = void (*)(FieldContext, float*);

SampleKernel kernel_of(FieldKind kind) {
  if (kind == FieldKind::blinn) return sample_bricks<FieldKind::blinn>;
  if (kind == FieldKind::soft_object) return sample_bricks<FieldKind::soft_object>;
  return sample_bricks<FieldKind::inverse_squared>;
}

}  // namespace

void sample_field_on_device(const CellListView& list, const FieldModel& model, float* values,
                            const Stream& stream) {
  const SampleKernel kernel = kernel_of(model.kind);
  const auto blocks = static_cast<unsigned>(BrickGrid(model.grid).blocks());
  const DeviceField field(list, model, stream);
  kernel<<<blocks, kBlockThreads, 0, stream.get()>>>(field.context(), values);
  check_launch("sample_bricks");
}

}  // namespace vdwmesh
