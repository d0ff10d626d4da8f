// Samples a blended field at every node of a grid, for FieldMesher::sample(): one warp per brick,
// with the same sums in the same order as in count_bricks.cu. All bricks are visited, because every
// node needs its value. A warp writes only the brick's own 8 x 8 x 8 nodes, without the halo, so no
// node is written twice. Each lane has two rows of eight nodes in registers.
#include "cuda/extract/brick_warp.cuh"
#include "cuda/extract/node_atoms.cuh"
#include "cuda/memory/launch.cuh"

namespace vdwmesh {
namespace {

// Bricks of a thread block, side by side along x. Their rows join into 32 consecutive values, 128
// bytes: a whole cache line of the device.
constexpr unsigned kBlockBricks = 4;
constexpr unsigned kBlockThreads = kBlockBricks * kWarp;
constexpr int kRowsApart = kBrickSide / 2;  // in z, between the two rows of a lane
// Rows of eight nodes that a warp writes at a time.
constexpr int kRowsAtOnce = static_cast<int>(kWarp) / kBrickSide;
static_assert(2 * kRowsAtOnce == kBrickSide);  // two times make a layer

using SampleAtom = NodeAtom<kBrickSide>;

// Shared memory of a warp, about 4 KB. Once all atoms are added they are no longer needed, and the
// values take their memory.
struct SampleShared {
  BrickIndex brick;
  double coordinate[3][kBrickSide];  // of the brick's own nodes, Å
  AtomStage stage;
  union {
    SampleAtom atoms[kAtomChunk];
    float values[kOwnRows][kBrickSide];
  };
};

// The launch grid: a thread block has kBlockBricks bricks along x and one along y and z. CUDA
// allows at most 65535 blocks along y and z.
dim3 blocks_of(const GridSpec& grid) {
  constexpr std::int32_t side = kBlockBricks, most = 65535;
  const std::int32_t height = brick_count(grid.cells.y), depth = brick_count(grid.cells.z);
  if (height > most || depth > most) {
    throw LimitExceeded("a field at every node: more than 65535 bricks along y or z");
  }
  return dim3(static_cast<unsigned>((brick_count(grid.cells.x) + side - 1) / side),
              static_cast<unsigned>(height), static_cast<unsigned>(depth));
}

// Fills `brick` and `coordinate`, by one warp: lane 8 * axis + node makes one coordinate. Ends with
// __syncwarp(). The last thread block may have bricks beyond the last brick along x; they are
// computed too, but store_rows() writes none of their nodes.
__device__ void share_nodes(const GridSpec& grid, SampleShared& s) {
  const BrickIndex brick{static_cast<std::int32_t>(blockIdx.x * kBlockBricks + threadIdx.x / kWarp),
                         static_cast<std::int32_t>(blockIdx.y),
                         static_cast<std::int32_t>(blockIdx.z)};
  const auto lane = static_cast<int>(threadIdx.x % kWarp);
  const int axis = lane / kBrickSide, node = lane % kBrickSide;
  const std::int32_t index = axis == 0 ? brick.x : (axis == 1 ? brick.y : brick.z);
  if (lane == 0) s.brick = brick;
  if (axis < 3)
    s.coordinate[axis][node] = lattice_coordinate(grid, axis, lattice_index(index, node));
  __syncwarp();
}

// A lane's rows of nodes: `low` is row (y, z) and `high` row (y, z + kRowsApart).
struct RowPair {
  int y, z;
  float low[kBrickSide] = {}, high[kBrickSide] = {};
};

// Adds an atom to one row of each lane, unless the rows of all lanes are out of its reach. The
// terms of two neighbouring nodes along x are read as one float4.
template <BlendedKind Kind>
__device__ void add_to_row(const NodeShape& nodes, const SampleAtom& atom, float scale,
                           const RowTerm& term, float (&row)[kBrickSide]) {
  if (__all_sync(kAllLanes, Kind::row_is_out_of_reach(nodes, term))) return;
  const auto* const pairs = reinterpret_cast<const float4*>(atom.term[0]);
#pragma unroll
  for (int x = 0; x < kBrickSide; x += 2) {
    const float4 pair = pairs[x / 2];
    row[x] = Kind::add_atom(nodes, term, {pair.x, pair.y}, scale, row[x]);
    row[x + 1] = Kind::add_atom(nodes, term, {pair.z, pair.w}, scale, row[x + 1]);
  }
}

// Adds the `count` atoms in shared memory to the values of the rows of the lane.
template <BlendedKind Kind>
__device__ void add_atoms(const NodeShape& nodes, const SampleShared& s, std::uint32_t count,
                          RowPair& rows) {
  for (std::uint32_t k = 0; k < count; ++k) {
    const SampleAtom& atom = s.atoms[k];
    const AxisTerm y = atom.term[1][rows.y];
    const RowTerm low = Kind::row_term(nodes, y, atom.term[2][rows.z]);
    const RowTerm high = Kind::row_term(nodes, y, atom.term[2][rows.z + kRowsApart]);
    add_to_row<Kind>(nodes, atom, s.stage.scale[k], low, rows.low);
    add_to_row<Kind>(nodes, atom, s.stage.scale[k], high, rows.high);
  }
}

// Writes the values at the brick's own nodes that belong to the grid. They go through shared
// memory, so that eight lanes write the eight nodes of a row, and the warp four rows at a time. The
// first __syncwarp() waits until no lane reads the atoms, whose memory the values take.
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
  // Grid indices are one below lattice indices; -1 and `width` are virtual nodes.
  const std::int64_t nx = lattice_index(s.brick.x, lane % kBrickSide) - 1;
  if (nx < 0 || nx >= width) return;
  const int x = lane % kBrickSide, y = lane / kBrickSide;
  const std::int64_t ny = lattice_index(s.brick.y, y) - 1, nz = lattice_index(s.brick.z, 0) - 1;
  const std::int64_t behind = ny + kRowsAtOnce, layer = height * width;
  const bool is_real = ny >= 0 && ny < height, behind_is_real = behind >= 0 && behind < height;
  std::int64_t to = (nz * height + ny) * width + nx;
#pragma unroll
  for (int z = 0; z < kBrickSide; ++z, to += layer) {
    if (nz + z < 0 || nz + z > grid.cells.z) continue;
    const int row = z * kBrickSide + y;
    if (is_real) values[to] = s.values[row][x];
    if (behind_is_real) values[to + kRowsAtOnce * width] = s.values[row + kRowsAtOnce][x];
  }
}

// Writes values[] at every node, in the order of SampledFieldView. A warp per brick, 4 bricks per
// thread block; about 16 KB of shared memory. The second launch bound makes 8 blocks fit on a
// multiprocessor.
template <BlendedKind Kind>
__global__ void __launch_bounds__(kBlockThreads, 8)
    sample_bricks(const __grid_constant__ FieldContext f, float* values) {
  __shared__ SampleShared shared[kBlockBricks];
  SampleShared& s = shared[threadIdx.x / kWarp];
  const NodeShape& nodes = f.nodes;
  share_nodes(f.model.grid, s);
  constexpr int end = kBrickSide - 1;
  const Vec3d lower{s.coordinate[0][0], s.coordinate[1][0], s.coordinate[2][0]};
  const Vec3d upper{s.coordinate[0][end], s.coordinate[1][end], s.coordinate[2][end]};
  const auto lane = static_cast<int>(threadIdx.x % kWarp);
  RowPair rows{lane % kBrickSide, lane / kBrickSide};
  const NodePlane plane = plane_of_lane(s.brick, s.coordinate);
  gather_by_warp(f, lower, upper, s.stage.waiting, kAtomChunk, [&](std::uint32_t count) {
    share_terms<Kind>(f, nodes, count, plane, s.stage, s.atoms);
    add_atoms<Kind>(nodes, s, count, rows);
    // Never ends the gathering.
    return false;
  });
  store_rows(f.model.grid, rows, s, values);
}

}  // namespace

void sample_field_on_device(const CellListView& list, const FieldModel& model, float* values,
                            const Stream& stream) {
  const DeviceField field(list, model, stream);
  with_blended(model.kind, [&]<class Kind>(Kind) {
    launch("sample_bricks", sample_bricks<Kind>, {blocks_of(model.grid), kBlockThreads}, stream,
           field.fields().context, values);
  });
}

}  // namespace vdwmesh
