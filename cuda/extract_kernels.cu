#include <algorithm>
#include <bit>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_select.cuh>

#include "cuda/brick_surface.cuh"
#include "cuda/cub_calls.cuh"
#include "cuda/device_structures.cuh"
#include "extract/case_table.hpp"
#include "extract/limits.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 128;  // of a block that works on one brick
constexpr int kRows = kBrickReach * kBrickReach;
constexpr int kOwnRows = kBrickSide * kBrickSide;

// ---- search
// --------------------------------------------------------------------------------------

// One thread per child of a block: keeps the key of the child where it may hold surface.
__global__ void test_children(FieldContext f, const std::uint64_t* parents, std::uint64_t count,
                              int child_level, std::uint64_t* keys, std::uint8_t* keep) {
  const std::uint64_t i = static_cast<std::uint64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i >= 8 * count) return;
  const BrickIndex parent = brick_of_key(parents[i / 8]);
  const int c = static_cast<int>(i % 8);
  const BrickIndex child{2 * parent.x + (c & 1), 2 * parent.y + (c >> 1 & 1),
                         2 * parent.z + (c >> 2)};
  keys[i] = brick_key(child);
  keep[i] = may_hold_surface(f.list, f.model, lattice_block(child, child_level)) ? 1 : 0;
}

struct KeyList {
  DeviceArray<std::uint64_t> keys;
  std::uint64_t count = 0;
};

KeyList surviving_children(const FieldContext& f, const KeyList& parents, int child_level,
                           std::uint64_t most, const Stream& stream) {
  const std::uint64_t children = 8 * parents.count;
  KeyList result;
  if (children == 0) return result;
  const DeviceArray<std::uint64_t> keys(children, stream.get());
  const DeviceArray<std::uint8_t> keep(children, stream.get());
  test_children<<<blocks_for(children, kThreads), kThreads, 0, stream.get()>>>(
      f, parents.keys.data(), parents.count, child_level, keys.data(), keep.data());
  check_launch("test_children");
  result.keys = DeviceArray<std::uint64_t>(children, stream.get());
  const DeviceArray<std::uint64_t> count(1, stream.get());
  run_cub("select", stream.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceSelect::Flagged(scratch, bytes, keys.data(), keep.data(), result.keys.data(),
                                      count.data(), static_cast<std::int64_t>(children),
                                      stream.get());
  });
  result.count = fetch(count.data(), stream);
  if (result.count > most) {
    throw LimitExceeded("the surface crosses more than " + std::to_string(result.count) +
                        " bricks of 8 x 8 x 8 nodes; at most " + std::to_string(most) +
                        " fit in the memory allowed: choose a larger spacing");
  }
  return result;
}

KeyList candidate_bricks_on_device(const FieldContext& f, std::uint64_t most,
                                   const Stream& stream) {
  const Vec3i& cells = f.model.grid.cells;
  const auto widest = static_cast<std::uint32_t>(
      std::max({brick_count(cells.x), brick_count(cells.y), brick_count(cells.z)}));
  const int levels = static_cast<int>(std::bit_width(widest - 1));
  KeyList blocks{DeviceArray<std::uint64_t>(1, stream.get()), 1};
  clear(blocks.keys, stream.get());
  for (int level = levels + 1; level > 0; --level) {
    blocks = surviving_children(f, blocks, level - 1, most, stream);
  }
  if (blocks.count == 0) return blocks;
  DeviceArray<std::uint64_t> sorted(blocks.count, stream.get());
  run_cub("sort", stream.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceRadixSort::SortKeys(scratch, bytes, blocks.keys.data(), sorted.data(),
                                          static_cast<std::int64_t>(blocks.count), 0, 64,
                                          stream.get());
  });
  blocks.keys = std::move(sorted);
  return blocks;
}

// ---- counting
// ------------------------------------------------------------------------------------

// Exclusive sums over the 64 own rows, by the first two warps; returns the total in thread 63's
// terms through `total`.
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

struct Counts {
  std::uint64_t* vertices;
  std::uint64_t* triangles;
  unsigned long long* clipped;
  unsigned long long* surface_bricks;
};

template <class Surface>
__global__ void __launch_bounds__(kThreads)
    count_bricks(FieldContext f, const std::uint64_t* keys, const CaseTable* table,
                 ActiveBrick* bricks, Counts counts) {
  __shared__ CountShared s;
  __shared__ typename Surface::Item items[kChunk];
  if (threadIdx.x == 0) {
    s.brick.key = keys[blockIdx.x];
    s.geometry = brick_geometry(f.model.grid, brick_of_key(s.brick.key));
  }
  __syncthreads();
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
  const auto* from = reinterpret_cast<const std::uint32_t*>(&s.brick);
  auto* to = reinterpret_cast<std::uint32_t*>(&bricks[blockIdx.x]);
  for (unsigned w = threadIdx.x; w < sizeof(ActiveBrick) / 4; w += kThreads) to[w] = from[w];
  if (threadIdx.x == 0) {
    counts.vertices[blockIdx.x] = s.brick.vertices;
    counts.triangles[blockIdx.x] = s.brick.triangles;
    if (s.brick.clipped_cells != 0) atomicAdd(counts.clipped, s.brick.clipped_cells);
    if (s.brick.vertices + s.brick.triangles != 0) atomicAdd(counts.surface_bricks, 1ull);
  }
}

// ---- emission
// ------------------------------------------------------------------------------------

struct EmitShared {
  GatherState gather;
  BrickGeometry geometry;
  ActiveBrick brick;
  std::uint32_t places[kChunk];
  std::uint64_t neighbour[kNeighbours];
};

struct BrickEdge {
  int x, y, z, axis;
};

// The grid edge that carries the brick's n-th vertex.
__device__ BrickEdge edge_of_vertex(const ActiveBrick& brick, std::uint32_t n) {
  int low = 0, high = kOwnRows - 1;  // the last row that starts at or before n
  while (low < high) {
    const int middle = (low + high + 1) / 2;
    if (brick.row_vertices[middle] <= n) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  const int y = low % kBrickSide, z = low / kBrickSide;
  const RowCrossings c = row_crossings(brick.signs, y, z);
  int left = static_cast<int>(n) - brick.row_vertices[low];
  for (int x = 0; x < kBrickSide; ++x) {
    for (int axis = 0; axis < 3; ++axis) {
      if ((c.along[axis] >> x & 1) == 0) continue;
      if (left == 0) return {x, y, z, axis};
      --left;
    }
  }
  return {0, 0, 0, 0};
}

template <class Surface>
__device__ void emit_vertices(const FieldContext& f, const EmitShared& s,
                              const typename Surface::Item* items, std::uint32_t item_count,
                              std::uint64_t base, const DeviceMeshView& mesh,
                              unsigned long long* clamped) {
  for (std::uint32_t n = threadIdx.x; n < s.brick.vertices; n += kThreads) {
    const BrickEdge e = edge_of_vertex(s.brick, n);
    const bool inside = (s.brick.signs.row[e.z][e.y] >> e.x & 1) != 0;
    const SurfaceVertex v = Surface::vertex(f, s.geometry, items, item_count,
                                            crossed_edge(inside, e.x, e.y, e.z, e.axis));
    mesh.positions[base + n] = v.position;
    mesh.normals[base + n] = v.normal;
    mesh.vertex_spheres[base + n] = on_sphere(v.sphere);
    if (v.clamped) atomicAdd(clamped, 1ull);
  }
}

__device__ void emit_cells(const BrickList& list, const EmitShared& s, std::uint64_t base,
                           const CaseTable& table, const DeviceMeshView& mesh) {
  const auto neighbour = [&](int slot) { return s.neighbour[slot]; };
  for (unsigned cell = threadIdx.x; cell < kBrickNodes; cell += kThreads) {
    const int x = static_cast<int>(cell) % kBrickSide;
    const int y = static_cast<int>(cell) / kBrickSide % kBrickSide;
    const int z = static_cast<int>(cell) / (kBrickSide * kBrickSide);
    const std::uint32_t inside = cell_case(s.brick.signs, x, y, z);
    const std::uint32_t half_edges = 3 * table.count(inside);
    if (half_edges == 0) continue;
    const std::uint64_t first = 3 * (base + s.brick.row_triangles[z * kBrickSide + y] +
                                     triangles_before(s.brick.signs, table, x, y, z));
    for (std::uint32_t h = 0; h < half_edges; ++h) {
      const CellEdge edge = cell_edge(table.edges[inside][h]);
      mesh.corners[first + h] =
          vertex_number(list, locate(neighbour, x + edge.x, y + edge.y, z + edge.z), edge.axis);
      mesh.opposite[first + h] =
          opposite_half_edge(list, table, neighbour, first, x, y, z, inside, static_cast<int>(h));
    }
  }
}

template <class Surface>
__global__ void __launch_bounds__(kThreads)
    emit_bricks(FieldContext f, BrickList list, const CaseTable* table, DeviceMeshView mesh,
                unsigned long long* clamped) {
  __shared__ EmitShared s;
  __shared__ typename Surface::Item items[kChunk];
  const auto* from = reinterpret_cast<const std::uint32_t*>(&list.bricks[blockIdx.x]);
  auto* to = reinterpret_cast<std::uint32_t*>(&s.brick);
  for (unsigned w = threadIdx.x; w < sizeof(ActiveBrick) / 4; w += kThreads) to[w] = from[w];
  __syncthreads();
  if (s.brick.vertices == 0 && s.brick.triangles == 0) return;
  if (threadIdx.x == 0) s.geometry = brick_geometry(f.model.grid, brick_of_key(s.brick.key));
  if (threadIdx.x < kNeighbours) {
    s.neighbour[threadIdx.x] = find_neighbour(list, s.brick.key, static_cast<int>(threadIdx.x));
  }
  __syncthreads();
  begin_gather(f.list, s.geometry.node(0, 0, 0),
               s.geometry.node(kBrickSide, kBrickSide, kBrickSide), s.gather);
  next_chunk(f.list, s.gather, s.places, kChunk,
             [&](std::uint32_t place) { return Surface::keep(f, s.geometry, place); });
  if (threadIdx.x < s.gather.gathered) {
    items[threadIdx.x] = Surface::item(f, s.geometry, s.places[threadIdx.x]);
  }
  __syncthreads();
  emit_vertices<Surface>(f, s, s.gather.finished ? items : nullptr, s.gather.gathered,
                         list.vertices[blockIdx.x], mesh, clamped);
  emit_cells(list, s, list.triangles[blockIdx.x], *table, mesh);
}

// ---- host side
// -----------------------------------------------------------------------------------

struct ExtractKernels {
  void (*count)(FieldContext, const std::uint64_t*, const CaseTable*, ActiveBrick*, Counts);
  void (*emit)(FieldContext, BrickList, const CaseTable*, DeviceMeshView, unsigned long long*);
};

template <class Surface>
ExtractKernels kernels_for() {
  return {count_bricks<Surface>, emit_bricks<Surface>};
}

ExtractKernels kernels_of(FieldKind kind) {
  switch (kind) {
    case FieldKind::vdw:
      return kernels_for<UnionSurface>();
    case FieldKind::blinn:
      return kernels_for<BlendedSurface<FieldKind::blinn>>();
    case FieldKind::soft_object:
      return kernels_for<BlendedSurface<FieldKind::soft_object>>();
    default:
      return kernels_for<BlendedSurface<FieldKind::inverse_squared>>();
  }
}

}  // namespace

DeviceExtraction extract_on_device(const CellListView& list, const FieldModel& model,
                                   const ExtractOptions& options, const Stream& stream) {
  DeviceExtraction result;
  result.grid = model.grid;
  const FieldContext f{list, model};
  const ExtractKernels kernels = kernels_of(model.kind);
  const DeviceArray<CaseTable> table = upload(&case_table(), 1, stream.get());
  StageClock clock(stream.get());

  begin_stage(options.monitor, "search", 1);
  const KeyList candidates =
      candidate_bricks_on_device(f, options.memory_limit / sizeof(ActiveBrick), stream);
  result.timings.search = clock.lap();
  advance(options.monitor, 1);

  begin_stage(options.monitor, "field", 1);
  const std::uint64_t n = candidates.count;
  require_device_memory(n * (sizeof(ActiveBrick) + 32), "the list of surface bricks");
  const DeviceArray<ActiveBrick> bricks(n, stream.get());
  const DeviceArray<std::uint64_t> vertices(n, stream.get()), triangles(n, stream.get());
  const DeviceArray<unsigned long long> totals(3, stream.get());
  clear(totals, stream.get());
  if (n > 0) {
    kernels.count<<<static_cast<unsigned>(n), kThreads, 0, stream.get()>>>(
        f, candidates.keys.data(), table.data(), bricks.data(),
        {vertices.data(), triangles.data(), totals.data(), totals.data() + 1});
    check_launch("count_bricks");
  }
  result.timings.count = clock.lap();
  const DeviceArray<std::uint64_t> first_vertex(n + 1, stream.get());
  const DeviceArray<std::uint64_t> first_triangle(n + 1, stream.get());
  sums_before(vertices.data(), n, first_vertex.data(), stream.get());
  sums_before(triangles.data(), n, first_triangle.data(), stream.get());
  const std::uint64_t vertex_total = fetch(first_vertex.data() + n, stream);
  const std::uint64_t triangle_total = fetch(first_triangle.data() + n, stream);
  result.timings.scan = clock.lap();
  advance(options.monitor, 1);

  begin_stage(options.monitor, "extract", 1);
  check_mesh_limits({vertex_total, triangle_total, options.connectivity, 0, model.grid.spacing},
                    options.memory_limit);
  require_device_memory(indexed_mesh_bytes(vertex_total, triangle_total, Connectivity::half_edges),
                        "the mesh");
  clock.restart();
  result.mesh = DeviceMesh(vertex_total, triangle_total, stream.get());
  if (n > 0) {
    kernels.emit<<<static_cast<unsigned>(n), kThreads, 0, stream.get()>>>(
        f, {bricks.data(), first_vertex.data(), first_triangle.data(), n}, table.data(),
        result.mesh.view(), totals.data() + 2);
    check_launch("emit_bricks");
  }
  result.timings.emit = clock.lap();
  advance(options.monitor, 1);

  result.stats.grid_clipped = fetch(totals.data(), stream);
  result.stats.surface_bricks = fetch(totals.data() + 1, stream);
  result.stats.clamped_vertices = fetch(totals.data() + 2, stream);
  result.stats.field_seconds =
      (result.timings.search + result.timings.count + result.timings.scan) * 1e-3;
  result.stats.extract_seconds = result.timings.emit * 1e-3;
  return result;
}

}  // namespace vdwmesh
