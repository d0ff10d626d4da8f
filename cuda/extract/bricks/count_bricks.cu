// Node signs of the candidate bricks, and the counts that follow from them, with one warp per
// brick. The warp gathers the spheres near the brick in list order, applies them in batches to the
// nodes of its rows, packs the signs, and counts vertices and triangles (count_brick()). For
// blended fields the values at the nodes of bricks with surface are kept for the vertices.
//
// Each of 27 lanes has three rows of nine nodes in registers; five lanes are idle while nodes are
// computed. The order of the sums is the list's, as on the CPU, so the values agree with the CPU's
// bit by bit.
#include "cuda/extract/bricks/brick_warp.cuh"
#include "cuda/extract/bricks/extract_stages.cuh"
#include "cuda/extract/bricks/kept_bricks.cuh"
#include "cuda/extract/node_atoms.cuh"
#include "cuda/extract/union_surface.cuh"
#include "cuda/memory/launch.cuh"

namespace vdwmesh {
namespace {

// Lane i < 27 has the rows i, i + 27 and i + 54 of the 81 rows 9 z + y: all with one y, and with
// three z that are kPlanesApart = 3 apart.
constexpr int kLaneRows = 3;
constexpr int kRowLanes = kRows / kLaneRows;
constexpr int kPlanesApart = kRowLanes / kBrickReach;

// Adds the `count` places of a batch to those that are kept, as far as there is room, and counts
// the batch to the places `before` the next one. By a warp.
template <std::uint32_t kPlaces>
__device__ void keep_places(const ListPlace* batch, std::uint32_t count, std::uint32_t& before,
                            NearPlaces<kPlaces>& near) {
  for (std::uint32_t k = threadIdx.x % kWarp; k < count && before + k < kPlaces; k += kWarp) {
    near.place[before + k] = batch[k];
  }
  before += count;
}

// ---- the union of balls ----

// Shared memory of a warp, about 3 KB. `places` is longer than a batch by a warp, as
// gather_by_warp() needs it.
struct UnionSignsShared {
  BrickGeometry geometry;
  ActiveBrick brick;
  ListPlace places[kMostSharedBalls + kWarp];
  Sphere balls[kMostSharedBalls];
};

// Sets bit x of `inside` for the nodes of row (y, z) that lie in one of the balls. The operations
// are those of squared_distance(), so the signs are exactly inside_ball()'s.
__device__ void add_to_row(const BrickGeometry& g, const Sphere* balls, std::uint32_t count, int y,
                           int z, std::uint32_t& inside) {
  for (std::uint32_t k = 0; k < count; ++k) {
    const Sphere& ball = balls[k];
    const double r2 = ball.radius * ball.radius;
    const double dy = g.coordinate[1][y] - ball.center.y, dz = g.coordinate[2][z] - ball.center.z;
    const double dyz2 = std::fma(dy, dy, dz * dz);
    if (dyz2 > r2) continue;
    for (int x = 0; x < kBrickReach; ++x) {
      const double dx = g.coordinate[0][x] - ball.center.x;
      inside |= std::fma(dx, dx, dyz2) <= r2 ? 1u << x : 0u;
    }
  }
}

// Counts candidate bricks of the union: writes bricks[i] and the counts of brick i, which has the
// key keys[i], and kept[i]. A warp per brick, 2 warps per thread block; about 6 KB of shared
// memory.
template <class Fields>
__global__ void __launch_bounds__(kBrickThreads)
    count_union(const __grid_constant__ Fields fields, const std::uint64_t* keys,
                std::uint64_t size, const CaseTable* table, ActiveBrick* bricks, KeptUnion* kept,
                BrickCounts counts) {
  __shared__ UnionSignsShared shared[kBrickWarps];
  const auto lane = static_cast<int>(threadIdx.x % kWarp);
  const std::uint64_t i =
      static_cast<std::uint64_t>(blockIdx.x) * kBrickWarps + threadIdx.x / kWarp;
  if (i >= size) return;
  UnionSignsShared& s = shared[threadIdx.x / kWarp];
  const FieldOfBlock own = fields.of(keys[i]);
  const FieldContext& f = own.field;
  share_geometry(f.model.grid, own.own_key(keys[i]), s.geometry);
  const int y = lane % kBrickReach, z = lane / kBrickReach;
  std::uint32_t inside[kLaneRows] = {};
  const Vec3d lower = s.geometry.node(0, 0, 0);
  const Vec3d upper = s.geometry.node(kBrickSide, kBrickSide, kBrickSide);
  NearPlaces<kMostSharedBalls>& near = kept[i].near;
  std::uint32_t before = 0;  // balls of the batches before
  const std::uint32_t met =
      gather_by_warp(f, lower, upper, s.places, kMostSharedBalls, [&](std::uint32_t count) {
        for (auto k = static_cast<std::uint32_t>(lane); k < count; k += kWarp) {
          s.balls[k] = f.list.spheres[s.places[k]];
        }
        keep_places(s.places, count, before, near);
        __syncwarp();
#pragma unroll
        for (int r = 0; r < kLaneRows && lane < kRowLanes; ++r) {
          add_to_row(s.geometry, s.balls, count, y, z + r * kPlanesApart, inside[r]);
        }
        // Never ends the gathering.
        return false;
      });
#pragma unroll
  for (int r = 0; r < kLaneRows; ++r) {
    if (lane < kRowLanes) {
      share_signs(s.geometry, inside[r], y, z + r * kPlanesApart, s.brick.signs);
    }
  }
  __syncwarp();
  count_brick(s.geometry, *table, s.brick);
  if (lane == 0) {
    s.brick.key = keys[i];
    near.count = met;
  }
  __syncwarp();
  store_count(s.brick, i, bricks, counts);
}

// ---- blended fields ----

// Shared memory of a warp, about 5 KB. Once all atoms are added they are no longer needed, and the
// values take their memory.
struct BlendedShared {
  BrickGeometry geometry;
  ActiveBrick brick;
  AtomStage stage;
  union {
    NodeAtom atoms[kAtomChunk];
    float values[kRows][kBrickReach];
  };
};

// The values at the nodes of a lane's rows. They stay in registers because all loops over them are
// unrolled: registers have no computed index.
using LaneRows = float[kLaneRows][kBrickReach];

// Adds the `count` atoms in shared memory to the values of the rows of the lane.
template <BlendedKind Kind>
__device__ void add_atoms(const NodeShape& nodes, const BlendedShared& s, std::uint32_t count,
                          LaneRows& rows) {
  const auto lane = static_cast<int>(threadIdx.x % kWarp);
  if (lane >= kRowLanes) return;
  const int y = lane % kBrickReach, z = lane / kBrickReach;
  for (std::uint32_t k = 0; k < count; ++k) {
    const NodeAtom& atom = s.atoms[k];
    const float scale = s.stage.scale[k];
    const AxisTerm ty = atom.term[1][y];
#pragma unroll
    for (int r = 0; r < kLaneRows; ++r) {
      const RowTerm term = Kind::row_term(nodes, ty, atom.term[2][z + r * kPlanesApart]);
#pragma unroll
      for (int x = 0; x < kBrickReach; ++x) {
        rows[r][x] = Kind::add_atom(nodes, term, atom.term[0][x], scale, rows[r][x]);
      }
    }
  }
}

// Sums all atoms near the brick, in list order, at the nodes of the rows of the lane. Returns the
// number of atoms, and keeps their places in `near`.
template <BlendedKind Kind>
__device__ std::uint32_t sum_field(const FieldContext& f, BlendedShared& s, LaneRows& rows,
                                   NearPlaces<kKeptAtoms>& near) {
  std::uint32_t before = 0;  // atoms of the batches before
  const NodeShape& nodes = f.nodes;
  const Vec3d lower = s.geometry.node(0, 0, 0);
  const Vec3d upper = s.geometry.node(kBrickSide, kBrickSide, kBrickSide);
  const NodePlane plane = plane_of_lane(s.geometry.brick, s.geometry.coordinate);
  return gather_by_warp(f, lower, upper, s.stage.waiting, kAtomChunk, [&](std::uint32_t count) {
    keep_places(s.stage.waiting, count, before, near);
    share_terms<Kind>(f, nodes, count, plane, s.stage, s.atoms);
    add_atoms<Kind>(nodes, s, count, rows);
    // Never ends the gathering.
    return false;
  });
}

// Stores the signs and the values of the rows of the lane in shared memory. The first __syncwarp()
// waits until no lane reads the atoms, whose memory the values take.
__device__ void share_rows(float isovalue, const LaneRows& rows, BlendedShared& s) {
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

// Counts candidate bricks of a blended field: writes bricks[i] and the counts of brick i, which has
// the key keys[i], and, if the brick has a vertex, kept[i]. A warp per brick, 2 warps per thread
// block; about 10 KB of shared memory. The second launch bound makes 12 blocks fit on a
// multiprocessor.
template <BlendedKind Kind, class Fields>
__global__ void __launch_bounds__(kBrickThreads, 12)
    count_blended(const __grid_constant__ Fields fields, const std::uint64_t* keys,
                  std::uint64_t size, const CaseTable* table, ActiveBrick* bricks,
                  KeptBlended* kept, BrickCounts counts) {
  __shared__ BlendedShared shared[kBrickWarps];
  const unsigned lane = threadIdx.x % kWarp;
  const std::uint64_t i =
      static_cast<std::uint64_t>(blockIdx.x) * kBrickWarps + threadIdx.x / kWarp;
  if (i >= size) return;
  BlendedShared& s = shared[threadIdx.x / kWarp];
  const FieldOfBlock own = fields.of(keys[i]);
  const FieldContext& f = own.field;
  share_geometry(f.model.grid, own.own_key(keys[i]), s.geometry);
  LaneRows rows = {};
  const std::uint32_t met = sum_field<Kind>(f, s, rows, kept[i].near);
  share_rows(static_cast<float>(f.model.isovalue), rows, s);
  count_brick(s.geometry, *table, s.brick);
  if (lane == 0) s.brick.key = keys[i];
  __syncwarp();
  store_count(s.brick, i, bricks, counts);
  if (s.brick.vertices == 0) return;
  const float* const from = &s.values[0][0];
  float* const to = kept[i].values;
  for (unsigned v = lane; v < kBrickValues; v += kWarp) to[v] = from[v];
  if (lane != 0) return;
  kept[i].near.count = met;
  atomicMax(&counts.parts[i % kCountParts].most_atoms, met);
}

template <class Fields>
void count_bricks(const Fields& fields, const std::uint64_t* keys, std::uint64_t size,
                  ActiveBrick* bricks, void* kept, const BrickCounts& counts,
                  const Stream& stream) {
  const CaseTable* const table = case_table_on_device();
  const LaunchShape shape = over(size, kBrickWarps, kBrickThreads);
  if (fields.kind() == FieldKind::vdw) {
    launch("count_union", count_union<Fields>, shape, stream, fields, keys, size, table, bricks,
           static_cast<KeptUnion*>(kept), counts);
  } else {
    with_blended(fields.kind(), [&]<class Kind>(Kind) {
      launch("count_blended", count_blended<Kind, Fields>, shape, stream, fields, keys, size, table,
             bricks, static_cast<KeptBlended*>(kept), counts);
    });
  }
}

}  // namespace

void count_bricks_on_device(const OneField& fields, const std::uint64_t* keys, std::uint64_t size,
                            ActiveBrick* bricks, void* kept, const BrickCounts& counts,
                            const Stream& stream) {
  count_bricks(fields, keys, size, bricks, kept, counts, stream);
}

void count_bricks_on_device(const FieldStack& fields, const std::uint64_t* keys, std::uint64_t size,
                            ActiveBrick* bricks, void* kept, const BrickCounts& counts,
                            const Stream& stream) {
  count_bricks(fields, keys, size, bricks, kept, counts, stream);
}

}  // namespace vdwmesh
