#include "cuda/extract/mesh_bricks.cuh"
#include "cuda/memory/cub_calls.cuh"
#include "extract/limits.hpp"

namespace vdwmesh {
namespace {

struct AddSums {
  __host__ __device__ BrickSums operator()(const BrickSums& a, const BrickSums& b) const {
    return {a.vertices + b.vertices, a.triangles + b.triangles};
  }
};

// By kCountParts threads.
__global__ void add_up(const CountPart* parts, const BrickSums* sums, BrickTotals* totals) {
  const CountPart& part = parts[threadIdx.x];
  if (threadIdx.x == 0) totals->sums = *sums;
  if (part.clipped_cells != 0) atomicAdd(&totals->clipped_cells, part.clipped_cells);
  if (part.surface_bricks != 0) atomicAdd(&totals->surface_bricks, part.surface_bricks);
  atomicMax(&totals->most_atoms, part.most_atoms);
}

// What is counted besides the bricks themselves; begins as zeros.
struct Tally {
  CountPart parts[kCountParts];
  BrickTotals totals;
};

}  // namespace

void check_tally(const DeviceEmissionTally& tally) {
  if (tally.missing_neighbours == 0) return;
  throw InternalError("the surface leaves bricks for neighbours that the search left out, at " +
                      std::to_string(tally.missing_neighbours) + " rows of cells");
}

CountedBricks count_and_scan(const KeyList& candidates, const CountKernel& count, StageMarks& marks,
                             const Stream& stream) {
  const std::uint64_t n = candidates.count;
  require_device_memory(n * (sizeof(ActiveBrick) + 2 * sizeof(BrickSums)),
                        "the list of surface bricks");
  CountedBricks counted;
  counted.bricks = DeviceArray<ActiveBrick>(n, stream.get());
  const DeviceArray<Tally> tally(1, stream.get());
  clear(tally, stream.get());
  // One more than bricks, so that the sums before it are those of all.
  const DeviceArray<BrickSums> sums(n + 1, stream.get());
  check_cuda(cudaMemsetAsync(sums.data() + n, 0, sizeof(BrickSums), stream.get()), "scan");
  count(counted.bricks.data(), {sums.data(), tally.data()->parts});
  marks.mark();
  counted.before = DeviceArray<BrickSums>(n + 1, stream.get());
  run_cub("scan", stream.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceScan::ExclusiveScan(scratch, bytes, sums.data(), counted.before.data(),
                                          AddSums{}, BrickSums{0, 0},
                                          static_cast<std::int64_t>(n + 1), stream.get());
  });
  BrickTotals* const totals = &tally.data()->totals;
  add_up<<<1, kCountParts, 0, stream.get()>>>(tally.data()->parts, counted.before.data() + n,
                                              totals);
  check_launch("add_up");
  counted.totals = fetch(totals, stream);
  marks.mark();
  return counted;
}

void mesh_bricks_on_device(const KeyList& candidates, double spacing, const BrickKernels& kernels,
                           LabelWidth width, const ExtractOptions& options,
                           DeviceExtraction& result, StageMarks& marks, const Stream& stream) {
  const std::uint64_t fixed = candidates.count * kBrickBytes;
  require_device_memory(fixed, "the list of surface bricks", options.device_memory);
  const CountedBricks counted = count_and_scan(candidates, kernels.count, marks, stream);
  const BrickTotals& totals = counted.totals;
  advance(options.monitor, 1);

  begin_stage(options.monitor, "extract", 1);
  const MeshSize size{totals.sums.vertices, totals.sums.triangles};
  const MeshArrays arrays{
      .connectivity = options.connectivity, .normals = options.normals, .width = width};
  check_mesh_limits({size, arrays, 0, spacing}, options.memory_limit);
  require_device_memory(indexed_mesh_bytes(size, arrays), "the mesh",
                        options.device_memory - fixed);
  const DeviceArray<DeviceEmissionTally> tally(1, stream.get());
  clear(tally, stream.get());
  result.mesh = DeviceMesh(size.vertices, size.triangles, stream.get(), width, options.normals,
                           options.connectivity);
  kernels.emit_vertices(counted, result.mesh.view(), &tally.data()->clamped);
  marks.mark();
  emit_triangles_on_device(counted.list(), find_triangle_neighbours(candidates, stream),
                           {0, candidates.count}, result.mesh.view(), tally.data(), stream);
  marks.mark();
  advance(options.monitor, 1);

  result.candidates = candidates.count;
  result.stats.grid_clipped = totals.clipped_cells;
  result.stats.surface_bricks = totals.surface_bricks;
  const DeviceEmissionTally noticed = fetch(tally.data(), stream);
  check_tally(noticed);
  result.stats.clamped_vertices = noticed.clamped;
  result.timings = {marks.stage(0), marks.stage(1), marks.stage(2), marks.stage(3), marks.stage(4)};
  result.stats.field_seconds =
      (result.timings.search + result.timings.count + result.timings.scan) * 1e-3;
  result.stats.extract_seconds = (result.timings.vertices + result.timings.triangles) * 1e-3;
}

}  // namespace vdwmesh
