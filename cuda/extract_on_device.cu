// Extraction from spheres on the device, stage by stage.
#include "cuda/mesh_bricks.cuh"

namespace vdwmesh {

DeviceExtraction extract_on_device(const CellListView& list, const FieldModel& model,
                                   const ExtractOptions& options, const Stream& stream) {
  DeviceExtraction result;
  const FieldContext f{list, model};
  StageMarks marks(stream.get());
  begin_stage(options.monitor, "field", 2);
  const KeyList candidates =
      candidate_bricks_on_device(f, options.memory_limit / sizeof(ActiveBrick), stream);
  marks.mark();
  advance(options.monitor, 1);
  const BrickKernels kernels{
      [&](const CaseTable* table, ActiveBrick* bricks, const BrickCounts& counts) {
        count_bricks_on_device(f, candidates, table, bricks, counts, stream);
      },
      [&](const CountedBricks& counted, const DeviceMeshView& mesh, unsigned long long* clamped) {
        emit_vertices_on_device(f, counted, mesh, clamped, stream);
      }};
  mesh_bricks_on_device(candidates, model.grid.spacing, kernels, DeviceLabels::spheres, options,
                        result, marks, stream);
  return result;
}

}  // namespace vdwmesh
