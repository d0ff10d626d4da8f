// Node signs and counts.
#include "cuda/brick_block.cuh"
#include "cuda/extract_stages.cuh"
#include "cuda/union_surface.cuh"
#include "extract/local_atom.hpp"

namespace vdwmesh {
namespace {

// ---- the union of balls: a block of threads per brick ----

constexpr std::uint32_t kPlaces = 512;  // gathered at a time

struct CountShared {
  GatherState gather;
  BrickGeometry geometry;
  ActiveBrick brick;
  std::uint32_t places[kPlaces];
};

__global__ void __launch_bounds__(kBrickThreads)
    count_union(FieldContext f, const std::uint64_t* keys, const CaseTable* table,
                ActiveBrick* bricks, BrickCounts counts) {
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
  __syncthreads();
  if (threadIdx.x >= kWarp) return;
  count_brick(s.geometry, *table, s.brick);
  __syncwarp();
  store_count(s.brick, blockIdx.x, bricks, counts);
}

// ---- blended fields: a warp per brick ----

constexpr unsigned kWarpsPerBlock = 4;
constexpr std::uint32_t kAtomChunk = 16;
constexpr int kLaneRows = 3;                  // rows of nodes a lane
constexpr int kRowLanes = kRows / kLaneRows;  // lane i: rows i, i + 27, i + 54
constexpr int kPlanesApart = kRowLanes / kBrickReach;

struct WarpShared {
  BrickGeometry geometry;
  ActiveBrick brick;
  std::uint32_t waiting[kAtomChunk + kWarp];  // places of atoms that reach the brick
  union {
    LocalAtom atoms[kAtomChunk];
    float values[kRows][kBrickReach];
  };
};

using LaneRows = float[kLaneRows][kBrickReach];

// Terms of the first `count` waiting atoms: a plane of nodes per lane, atom after atom.
template <FieldKind kind>
__device__ void share_terms(const FieldContext& f, const NodeShape& nodes, std::uint32_t count,
                            WarpShared& s) {
  const unsigned lane = threadIdx.x % kWarp;
  __syncwarp();
  if (lane < count) {
    const Sphere& atom = f.list.spheres[s.waiting[lane]];
    s.atoms[lane].scale = static_cast<float>(inverse_square_scale(f.model, atom.radius));
  }
  __syncwarp();
  const auto axis = static_cast<int>(lane) / kBrickReach;
  const auto node = static_cast<int>(lane) % kBrickReach;
  for (std::uint32_t k = 0; k < count && axis < 3; ++k) {
    s.atoms[k].term[axis][node] = brick_term<kind>(
        f.model, nodes, s.geometry, f.list.spheres[s.waiting[k]], s.atoms[k].scale, axis, node);
  }
  __syncwarp();
}

template <FieldKind kind>
__device__ void add_atoms(const NodeShape& nodes, const LocalAtom* atoms, std::uint32_t count,
                          LaneRows& rows) {
  const auto lane = static_cast<int>(threadIdx.x % kWarp);
  if (lane >= kRowLanes) return;
  const int y = lane % kBrickReach, z = lane / kBrickReach;
  for (std::uint32_t k = 0; k < count; ++k) {
    const LocalAtom& atom = atoms[k];
    const AxisTerm ty = atom.term[1][y];
#pragma unroll
    for (int r = 0; r < kLaneRows; ++r) {
      const RowTerm term = row_term<kind>(nodes, ty, atom.term[2][z + r * kPlanesApart]);
#pragma unroll
      for (int x = 0; x < kBrickReach; ++x) {
        rows[r][x] = add_atom<kind>(nodes, term, atom.term[0][x], atom.scale, rows[r][x]);
      }
    }
  }
}

// Sums at the lane's nodes over all atoms, in list order; returns how many reach the brick.
template <FieldKind kind>
__device__ std::uint32_t sum_field(const FieldContext& f, WarpShared& s, LaneRows& rows) {
  const NodeShape nodes = node_shape(f.model);
  const unsigned lane = threadIdx.x % kWarp;
  const Vec3d lower = s.geometry.node(0, 0, 0);
  const Vec3d upper = s.geometry.node(kBrickSide, kBrickSide, kBrickSide);
  std::uint32_t waiting = 0, met = 0;
  const auto add = [&](std::uint32_t count) {
    share_terms<kind>(f, nodes, count, s);
    add_atoms<kind>(nodes, s.atoms, count, rows);
    waiting -= count;
    met += count;
    const std::uint32_t next = lane < waiting ? s.waiting[count + lane] : 0;
    __syncwarp();
    if (lane < waiting) s.waiting[lane] = next;
    __syncwarp();
  };
  for (int l = 0; l < f.list.level_count; ++l) {
    visit_level_by_warp(f.list.levels[l], lower, upper, [&](std::uint32_t place, bool valid) {
      const bool kept = valid && reaches_box(f.model, lower, upper, f.list.spheres[place]);
      const unsigned votes = __ballot_sync(kAllLanes, kept);
      if (kept) s.waiting[waiting + __popc(votes & ((1u << lane) - 1))] = place;
      waiting += static_cast<std::uint32_t>(__popc(votes));
      while (waiting >= kAtomChunk) add(kAtomChunk);
      return false;
    });
  }
  if (waiting > 0) add(waiting);
  return met;
}

// Signs of the lane's rows; the values go to shared memory.
__device__ void share_rows(float isovalue, const LaneRows& rows, WarpShared& s) {
  const auto lane = static_cast<int>(threadIdx.x % kWarp);
  __syncwarp();
  for (int r = 0; r < kLaneRows && lane < kRowLanes; ++r) {
    const int row = lane + r * kRowLanes;
    std::uint32_t inside = 0;
    for (int x = 0; x < kBrickReach; ++x) {
      inside |= rows[r][x] >= isovalue ? 1u << x : 0u;
      s.values[row][x] = rows[r][x];
    }
    share_signs(s.geometry, inside, row % kBrickReach, row / kBrickReach, s.brick.signs);
  }
  __syncwarp();
}

template <FieldKind kind>
__global__ void __launch_bounds__(kWarpsPerBlock* kWarp, 5)
    count_blended(FieldContext f, const std::uint64_t* keys, std::uint64_t size,
                  const CaseTable* table, ActiveBrick* bricks, float* values, BrickCounts counts) {
  __shared__ WarpShared shared[kWarpsPerBlock];
  const unsigned lane = threadIdx.x % kWarp;
  const std::uint64_t i =
      static_cast<std::uint64_t>(blockIdx.x) * kWarpsPerBlock + threadIdx.x / kWarp;
  if (i >= size) return;
  WarpShared& s = shared[threadIdx.x / kWarp];
  share_geometry_by_warp(f.model.grid, keys[i], s.geometry);
  LaneRows rows = {};
  const std::uint32_t met = sum_field<kind>(f, s, rows);
  share_rows(static_cast<float>(f.model.isovalue), rows, s);
  count_brick(s.geometry, *table, s.brick);
  if (lane == 0) s.brick.key = keys[i];
  __syncwarp();
  store_count(s.brick, i, bricks, counts);
  if (s.brick.vertices == 0) return;
  const float* const from = &s.values[0][0];
  float* const to = values + i * kBrickValues;
  for (unsigned v = lane; v < kBrickValues; v += kWarp) to[v] = from[v];
  if (lane == 0) atomicMax(&counts.parts[i % kCountParts].most_atoms, met);
}

using BlendedCount = void (*)(FieldContext, const std::uint64_t*, std::uint64_t, const CaseTable*,
                              ActiveBrick*, float*, BrickCounts);

BlendedCount blended_count_of(FieldKind kind) {
  if (kind == FieldKind::blinn) return count_blended<FieldKind::blinn>;
  if (kind == FieldKind::soft_object) return count_blended<FieldKind::soft_object>;
  return count_blended<FieldKind::inverse_squared>;
}

}  // namespace

void count_bricks_on_device(const FieldContext& f, const std::uint64_t* keys, std::uint64_t size,
                            const CaseTable* table, ActiveBrick* bricks, float* values,
                            const BrickCounts& counts, const Stream& stream) {
  if (size == 0) return;
  if (f.model.kind == FieldKind::vdw) {
    count_union<<<static_cast<unsigned>(size), kBrickThreads, 0, stream.get()>>>(f, keys, table,
                                                                                 bricks, counts);
  } else {
    blended_count_of(
        f.model
            .kind)<<<blocks_for(size, kWarpsPerBlock), kWarpsPerBlock * kWarp, 0, stream.get()>>>(
        f, keys, size, table, bricks, values, counts);
  }
  check_launch("count_bricks");
}

}  // namespace vdwmesh
