#include "cuda/cub_calls.cuh"
#include "cuda/mesh_bricks.cuh"
#include "extract/limits.hpp"

namespace vdwmesh {
namespace {

// By kCountParts threads.
__global__ void add_up(const CountPart* parts, const std::uint64_t* vertices,
                       const std::uint64_t* triangles, BrickTotals* totals) {
  const CountPart& part = parts[threadIdx.x];
  if (threadIdx.x == 0) {
    totals->vertices = *vertices;
    totals->triangles = *triangles;
  }
  if (part.clipped_cells != 0) atomicAdd(&totals->clipped_cells, part.clipped_cells);
  if (part.surface_bricks != 0) atomicAdd(&totals->surface_bricks, part.surface_bricks);
  atomicMax(&totals->most_atoms, part.most_atoms);
}

CountedBricks count_and_scan(const KeyList& candidates, const CaseTable* table,
                             const BrickKernels& kernels, StageMarks& marks, const Stream& stream) {
  const std::uint64_t n = candidates.count;
  require_device_memory(n * (sizeof(ActiveBrick) + 4 * sizeof(std::uint64_t)),
                        "the list of surface bricks");
  CountedBricks counted;
  counted.bricks = DeviceArray<ActiveBrick>(n, stream.get());
  const DeviceArray<CountPart> parts(kCountParts, stream.get());
  const DeviceArray<BrickTotals> totals(1, stream.get());
  clear(parts, stream.get());
  clear(totals, stream.get());
  const DeviceArray<std::uint64_t> vertices(n, stream.get()), triangles(n, stream.get());
  kernels.count(table, counted.bricks.data(), {vertices.data(), triangles.data(), parts.data()});
  marks.mark();
  counted.first_vertex = DeviceArray<std::uint64_t>(n + 1, stream.get());
  counted.first_triangle = DeviceArray<std::uint64_t>(n + 1, stream.get());
  sums_before(vertices.data(), n, counted.first_vertex.data(), stream.get());
  sums_before(triangles.data(), n, counted.first_triangle.data(), stream.get());
  add_up<<<1, kCountParts, 0, stream.get()>>>(parts.data(), counted.first_vertex.data() + n,
                                              counted.first_triangle.data() + n, totals.data());
  check_launch("add_up");
  counted.totals = fetch(totals.data(), stream);
  marks.mark();
  return counted;
}

}  // namespace

void mesh_bricks_on_device(const KeyList& candidates, double spacing, const BrickKernels& kernels,
                           DeviceLabels labels, const ExtractOptions& options,
                           DeviceExtraction& result, StageMarks& marks, const Stream& stream) {
  const DeviceArray<CaseTable> table = upload(&case_table(), 1, stream.get());
  const CountedBricks counted = count_and_scan(candidates, table.data(), kernels, marks, stream);
  const BrickTotals& totals = counted.totals;
  advance(options.monitor, 1);

  begin_stage(options.monitor, "extract", 1);
  check_mesh_limits({totals.vertices, totals.triangles, options.connectivity, 0, spacing},
                    options.memory_limit);
  require_device_memory(
      indexed_mesh_bytes(totals.vertices, totals.triangles, Connectivity::half_edges), "the mesh");
  const DeviceArray<unsigned long long> clamped(1, stream.get());
  clear(clamped, stream.get());
  result.mesh = DeviceMesh(totals.vertices, totals.triangles, stream.get(), labels);
  kernels.emit_vertices(counted, result.mesh.view(), clamped.data());
  marks.mark();
  emit_triangles_on_device(counted.list(), candidates, table.data(), result.mesh.view(), stream);
  marks.mark();
  advance(options.monitor, 1);

  result.stats.grid_clipped = totals.clipped_cells;
  result.stats.surface_bricks = totals.surface_bricks;
  result.stats.clamped_vertices = fetch(clamped.data(), stream);
  result.timings = {marks.stage(0), marks.stage(1), marks.stage(2), marks.stage(3), marks.stage(4)};
  result.stats.field_seconds =
      (result.timings.search + result.timings.count + result.timings.scan) * 1e-3;
  result.stats.extract_seconds = (result.timings.vertices + result.timings.triangles) * 1e-3;
}

}  // namespace vdwmesh
