// Node signs and counts, a block of threads per brick.
#include "cuda/blended_atoms.cuh"
#include "cuda/brick_block.cuh"
#include "cuda/extract_stages.cuh"
#include "cuda/union_surface.cuh"

namespace vdwmesh {
namespace {

constexpr std::uint32_t kPlaces = 512;  // gathered at a time

struct CountShared {
  GatherState gather;
  BrickGeometry geometry;
  ActiveBrick brick;
  std::uint32_t places[kPlaces];
};

// What a block does once the signs of its brick stand in shared memory.
__device__ void finish_brick(const BrickGeometry& geometry, const CaseTable& table,
                             ActiveBrick& brick, ActiveBrick* bricks, const BrickCounts& counts) {
  __syncthreads();
  if (threadIdx.x < kWarp) count_brick(geometry, table, brick);
  __syncthreads();
  copy_brick(&brick, &bricks[blockIdx.x], threadIdx.x, blockDim.x);
  if (threadIdx.x != 0) return;
  counts.sums[blockIdx.x] = {brick.vertices, brick.triangles};
  CountPart& part = counts.parts[blockIdx.x % kCountParts];
  if (brick.clipped_cells != 0) atomicAdd(&part.clipped_cells, brick.clipped_cells);
  if (brick.vertices + brick.triangles != 0) atomicAdd(&part.surface_bricks, 1ull);
}

__global__ void __launch_bounds__(kBrickThreads)
    count_union(FieldContext f, const std::uint64_t* keys, const CaseTable* table,
                ActiveBrick* bricks, float*, BrickCounts counts) {
  __shared__ CountShared s;
  __shared__ UnionSurface::Item items[kChunk];
  if (threadIdx.x == 0) s.brick.key = keys[blockIdx.x];
  share_geometry(f.model.grid, keys[blockIdx.x], s.geometry);
  begin_gather(f.list, s.geometry.node(0, 0, 0),
               s.geometry.node(kBrickSide, kBrickSide, kBrickSide), s.gather);
  UnionSurface::RowState row;
  const int y = static_cast<int>(threadIdx.x) % kBrickReach;
  const int z = static_cast<int>(threadIdx.x) / kBrickReach;
  do {
    next_chunk(f.list, s.gather, s.places, kPlaces,
               [&](std::uint32_t place) { return UnionSurface::keep(f, s.geometry, place); });
    for (std::uint32_t first = 0; first < s.gather.gathered; first += kChunk) {
      const std::uint32_t left = s.gather.gathered - first, count = left < kChunk ? left : kChunk;
      if (threadIdx.x < count) {
        items[threadIdx.x] = UnionSurface::item(f, s.places[first + threadIdx.x]);
      }
      __syncthreads();
      if (threadIdx.x < kRows) UnionSurface::add_row(s.geometry, items, count, y, z, row);
      __syncthreads();
    }
  } while (!s.gather.finished);
  if (threadIdx.x < kRows) share_signs(s.geometry, row.inside, y, z, s.brick.signs);
  finish_brick(s.geometry, *table, s.brick, bricks, counts);
}

constexpr unsigned kRowThreads = 3 * kWarp;  // a row of nodes each
constexpr std::uint32_t kAtomChunk = 32;

template <FieldKind kind>
__device__ void add_rows(const NodeShape& nodes, const LocalAtom* atoms, std::uint32_t count, int y,
                         int z, float (&row)[kBrickReach]) {
  for (std::uint32_t k = 0; k < count; ++k) {
    const LocalAtom& atom = atoms[k];
    const RowTerm term = row_term<kind>(nodes, atom.term[1][y], atom.term[2][z]);
    if (row_is_out_of_reach<kind>(nodes, term)) continue;
#pragma unroll
    for (int x = 0; x < kBrickReach; ++x) {
      row[x] = add_atom<kind>(nodes, term, atom.term[0][x], atom.scale, row[x]);
    }
  }
}

template <FieldKind kind>
__global__ void __launch_bounds__(kRowThreads)
    count_blended(FieldContext f, const std::uint64_t* keys, const CaseTable* table,
                  ActiveBrick* bricks, float* values, BrickCounts counts) {
  __shared__ CountShared s;
  __shared__ union {
    LocalAtom atoms[kAtomChunk];
    float values[kRows][kBrickReach];
  } u;
  const NodeShape nodes = node_shape(f.model);
  if (threadIdx.x == 0) s.brick.key = keys[blockIdx.x];
  share_geometry(f.model.grid, keys[blockIdx.x], s.geometry);
  begin_gather(f.list, s.geometry.node(0, 0, 0),
               s.geometry.node(kBrickSide, kBrickSide, kBrickSide), s.gather);
  float row[kBrickReach] = {};
  const int y = static_cast<int>(threadIdx.x) % kBrickReach;
  const int z = static_cast<int>(threadIdx.x) / kBrickReach;
  std::uint32_t met = 0;
  do {
    next_chunk(f.list, s.gather, s.places, kPlaces, [&](std::uint32_t place) {
      return reaches_brick(f.model, s.geometry, f.list.spheres[place]);
    });
    for (std::uint32_t first = 0; first < s.gather.gathered; first += kAtomChunk) {
      const std::uint32_t left = s.gather.gathered - first;
      const std::uint32_t count = left < kAtomChunk ? left : kAtomChunk;
      share_atoms<kind>(f, nodes, s.geometry, s.places + first, count, u.atoms);
      if (threadIdx.x < kRows) add_rows<kind>(nodes, u.atoms, count, y, z, row);
      __syncthreads();
    }
    met += s.gather.gathered;
  } while (!s.gather.finished);
  if (threadIdx.x < kRows) {
    const auto isovalue = static_cast<float>(f.model.isovalue);
    std::uint32_t inside = 0;
    for (int x = 0; x < kBrickReach; ++x) {
      inside |= row[x] >= isovalue ? 1u << x : 0u;
      u.values[threadIdx.x][x] = row[x];
    }
    share_signs(s.geometry, inside, y, z, s.brick.signs);
  }
  finish_brick(s.geometry, *table, s.brick, bricks, counts);
  if (s.brick.vertices == 0) return;
  const float* const shared = &u.values[0][0];
  float* const own = values + static_cast<std::uint64_t>(blockIdx.x) * kBrickValues;
  for (unsigned i = threadIdx.x; i < kBrickValues; i += kRowThreads) own[i] = shared[i];
  if (threadIdx.x == 0) atomicMax(&counts.parts[blockIdx.x % kCountParts].most_atoms, met);
}

using CountKernel = void (*)(FieldContext, const std::uint64_t*, const CaseTable*, ActiveBrick*,
                             float*, BrickCounts);

struct CountLaunch {
  CountKernel kernel;
  unsigned threads;
};

CountLaunch launch_of(FieldKind kind) {
  switch (kind) {
    case FieldKind::vdw:
      return {count_union, kBrickThreads};
    case FieldKind::blinn:
      return {count_blended<FieldKind::blinn>, kRowThreads};
    case FieldKind::soft_object:
      return {count_blended<FieldKind::soft_object>, kRowThreads};
    default:
      return {count_blended<FieldKind::inverse_squared>, kRowThreads};
  }
}

}  // namespace

void count_bricks_on_device(const FieldContext& f, const KeyList& candidates,
                            const CaseTable* table, ActiveBrick* bricks, float* values,
                            const BrickCounts& counts, const Stream& stream) {
  if (candidates.count == 0) return;
  const CountLaunch launch = launch_of(f.model.kind);
  launch.kernel<<<static_cast<unsigned>(candidates.count), launch.threads, 0, stream.get()>>>(
      f, candidates.keys.data(), table, bricks, values, counts);
  check_launch("count_bricks");
}

}  // namespace vdwmesh
