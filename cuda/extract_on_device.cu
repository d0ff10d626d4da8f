// Extraction on the device, stage by stage.
#include "cuda/cub_calls.cuh"
#include "cuda/extract_stages.cuh"
#include "extract/limits.hpp"

namespace vdwmesh {
namespace {

// What counting leaves behind.
struct CountedBricks {
  DeviceArray<ActiveBrick> bricks;
  DeviceArray<std::uint64_t> first_vertex, first_triangle;  // of each brick, and the totals
  DeviceArray<unsigned long long> totals;                   // clipped cells, bricks, clamped
  std::uint64_t vertices = 0, triangles = 0;

  BrickList list() const {
    return {bricks.data(), first_vertex.data(), first_triangle.data(), bricks.size()};
  }
};

CountedBricks count_and_scan(const FieldContext& f, const KeyList& candidates,
                             const CaseTable* table, ExtractTimings& timings, StageClock& clock,
                             const Stream& stream) {
  const std::uint64_t n = candidates.count;
  require_device_memory(n * (sizeof(ActiveBrick) + 4 * sizeof(std::uint64_t)),
                        "the list of surface bricks");
  CountedBricks counted;
  counted.bricks = DeviceArray<ActiveBrick>(n, stream.get());
  counted.totals = DeviceArray<unsigned long long>(3, stream.get());
  clear(counted.totals, stream.get());
  const DeviceArray<std::uint64_t> vertices(n, stream.get()), triangles(n, stream.get());
  count_bricks_on_device(
      f, candidates, table, counted.bricks.data(),
      {vertices.data(), triangles.data(), counted.totals.data(), counted.totals.data() + 1},
      stream);
  timings.count = clock.lap();
  counted.first_vertex = DeviceArray<std::uint64_t>(n + 1, stream.get());
  counted.first_triangle = DeviceArray<std::uint64_t>(n + 1, stream.get());
  sums_before(vertices.data(), n, counted.first_vertex.data(), stream.get());
  sums_before(triangles.data(), n, counted.first_triangle.data(), stream.get());
  counted.vertices = fetch(counted.first_vertex.data() + n, stream);
  counted.triangles = fetch(counted.first_triangle.data() + n, stream);
  timings.scan = clock.lap();
  return counted;
}

}  // namespace

DeviceExtraction extract_on_device(const CellListView& list, const FieldModel& model,
                                   const ExtractOptions& options, const Stream& stream) {
  DeviceExtraction result;
  const FieldContext f{list, model};
  const DeviceArray<CaseTable> table = upload(&case_table(), 1, stream.get());
  StageClock clock(stream.get());
  begin_stage(options.monitor, "field", 2);
  const KeyList candidates =
      candidate_bricks_on_device(f, options.memory_limit / sizeof(ActiveBrick), stream);
  result.timings.search = clock.lap();
  advance(options.monitor, 1);
  const CountedBricks counted =
      count_and_scan(f, candidates, table.data(), result.timings, clock, stream);
  advance(options.monitor, 1);

  begin_stage(options.monitor, "extract", 1);
  check_mesh_limits(
      {counted.vertices, counted.triangles, options.connectivity, 0, model.grid.spacing},
      options.memory_limit);
  require_device_memory(
      indexed_mesh_bytes(counted.vertices, counted.triangles, Connectivity::half_edges),
      "the mesh");
  clock.restart();
  result.mesh = DeviceMesh(counted.vertices, counted.triangles, stream.get());
  emit_vertices_on_device(f, counted.list(), result.mesh.view(), counted.totals.data() + 2, stream);
  result.timings.vertices = clock.lap();
  emit_triangles_on_device(counted.list(), table.data(), result.mesh.view(), stream);
  result.timings.triangles = clock.lap();
  advance(options.monitor, 1);

  result.stats.grid_clipped = fetch(counted.totals.data(), stream);
  result.stats.surface_bricks = fetch(counted.totals.data() + 1, stream);
  result.stats.clamped_vertices = fetch(counted.totals.data() + 2, stream);
  result.stats.field_seconds =
      (result.timings.search + result.timings.count + result.timings.scan) * 1e-3;
  result.stats.extract_seconds = (result.timings.vertices + result.timings.triangles) * 1e-3;
  return result;
}

}  // namespace vdwmesh
