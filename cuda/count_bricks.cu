// Node signs and counts, a block of threads per brick.
#include "cuda/brick_block.cuh"
#include "cuda/brick_surface.cuh"
#include "cuda/extract_stages.cuh"

namespace vdwmesh {
namespace {

// Exclusive sums over the 64 own rows, by the first two warps; `warp_total` keeps their two totals.
// All threads of the block call it.
__device__ void sum_rows(std::uint32_t value, std::uint16_t* before, std::uint32_t* warp_total) {
  const unsigned lane = threadIdx.x % kWarp;
  std::uint32_t sum = value;
  for (unsigned step = 1; step < kWarp; step *= 2) {
    const std::uint32_t below = __shfl_up_sync(kAllLanes, sum, step);
    if (lane >= step) sum += below;
  }
  if (threadIdx.x < kOwnRows && lane == kWarp - 1) warp_total[threadIdx.x / kWarp] = sum;
  __syncthreads();
  if (threadIdx.x < kOwnRows) {
    const std::uint32_t earlier = threadIdx.x < kWarp ? 0 : warp_total[0];
    before[threadIdx.x] = static_cast<std::uint16_t>(earlier + sum - value);
  }
  __syncthreads();
}

struct CountShared {
  GatherState gather;
  BrickGeometry geometry;
  ActiveBrick brick;
  std::uint32_t places[kChunk];
  std::uint32_t warp_total[2];
};

// Counts what the brick's signs imply: vertices and triangles per row, and in all.
__device__ void count_brick(CountShared& s, const CaseTable& table) {
  std::uint32_t vertices = 0, triangles = 0, clipped = 0;
  if (threadIdx.x < kOwnRows) {
    const int y = static_cast<int>(threadIdx.x) % kBrickSide;
    const int z = static_cast<int>(threadIdx.x) / kBrickSide;
    vertices = static_cast<std::uint32_t>(vertex_count(row_crossings(s.brick.signs, y, z)));
    const std::uint32_t mixed = mixed_cells(s.brick.signs, y, z);
    for (std::uint32_t cells = mixed; cells != 0; cells &= cells - 1) {
      triangles += table.count(cell_case(s.brick.signs, __ffs(static_cast<int>(cells)) - 1, y, z));
    }
    clipped = static_cast<std::uint32_t>(count_bits(mixed & border_cells(s.geometry, y, z)));
  }
  sum_rows(vertices, s.brick.row_vertices, s.warp_total);
  if (threadIdx.x == 0) s.brick.vertices = s.warp_total[0] + s.warp_total[1];
  __syncthreads();
  sum_rows(triangles, s.brick.row_triangles, s.warp_total);
  if (threadIdx.x == 0) s.brick.triangles = s.warp_total[0] + s.warp_total[1];
  __syncthreads();
  if (threadIdx.x == 0) s.brick.clipped_cells = 0;
  __syncthreads();
  if (clipped != 0) atomicAdd(&s.brick.clipped_cells, clipped);
  __syncthreads();
}

template <class Surface>
__global__ void __launch_bounds__(kBrickThreads)
    count_bricks(FieldContext f, const std::uint64_t* keys, const CaseTable* table,
                 ActiveBrick* bricks, BrickCounts counts) {
  __shared__ CountShared s;
  __shared__ typename Surface::Item items[kChunk];
  if (threadIdx.x == 0) s.brick.key = keys[blockIdx.x];
  share_geometry(f.model.grid, keys[blockIdx.x], s.geometry);
  begin_gather(f.list, s.geometry.node(0, 0, 0),
               s.geometry.node(kBrickSide, kBrickSide, kBrickSide), s.gather);
  typename Surface::RowState row;
  const int y = static_cast<int>(threadIdx.x) % kBrickReach;
  const int z = static_cast<int>(threadIdx.x) / kBrickReach;
  do {
    next_chunk(f.list, s.gather, s.places, kChunk,
               [&](std::uint32_t place) { return Surface::keep(f, s.geometry, place); });
    if (threadIdx.x < s.gather.gathered) {
      items[threadIdx.x] = Surface::item(f, s.geometry, s.places[threadIdx.x]);
    }
    __syncthreads();
    if (threadIdx.x < kRows) {
      Surface::add_row(f, s.geometry, items, s.gather.gathered, y, z, row);
    }
  } while (!s.gather.finished);
  if (threadIdx.x < kRows) {
    const bool real = (s.geometry.real[1] >> y & s.geometry.real[2] >> z & 1) != 0;
    const std::uint32_t signs = Surface::row_signs(f, row) & s.geometry.real[0];
    s.brick.signs.row[z][y] = real ? static_cast<std::uint16_t>(signs) : std::uint16_t{0};
  }
  __syncthreads();
  count_brick(s, *table);
  copy_brick(&s.brick, &bricks[blockIdx.x]);
  if (threadIdx.x == 0) {
    counts.vertices[blockIdx.x] = s.brick.vertices;
    counts.triangles[blockIdx.x] = s.brick.triangles;
    if (s.brick.clipped_cells != 0) atomicAdd(counts.clipped_cells, s.brick.clipped_cells);
    if (s.brick.vertices + s.brick.triangles != 0) atomicAdd(counts.surface_bricks, 1ull);
  }
}

using CountKernel = void (*)(FieldContext, const std::uint64_t*, const CaseTable*, ActiveBrick*,
                             BrickCounts);

CountKernel kernel_of(FieldKind kind) {
  switch (kind) {
    case FieldKind::vdw:
      return count_bricks<UnionSurface>;
    case FieldKind::blinn:
      return count_bricks<BlendedSurface<FieldKind::blinn>>;
    case FieldKind::soft_object:
      return count_bricks<BlendedSurface<FieldKind::soft_object>>;
    default:
      return count_bricks<BlendedSurface<FieldKind::inverse_squared>>;
  }
}

}  // namespace

void count_bricks_on_device(const FieldContext& f, const KeyList& candidates,
                            const CaseTable* table, ActiveBrick* bricks, const BrickCounts& counts,
                            const Stream& stream) {
  if (candidates.count == 0) return;
  kernel_of(
      f.model.kind)<<<static_cast<unsigned>(candidates.count), kBrickThreads, 0, stream.get()>>>(
      f, candidates.keys.data(), table, bricks, counts);
  check_launch("count_bricks");
}

}  // namespace vdwmesh
