// Extraction from spheres on the device, stage by stage.
#include "cuda/extract/mesh_bricks.cuh"

namespace vdwmesh {

DeviceExtraction extract_on_device(const CellListView& list, const FieldModel& model,
                                   const ExtractOptions& options, const Stream& stream) {
  DeviceExtraction result;
  StageMarks marks(stream.get());
  begin_stage(options.monitor, "field", 2);
  const DeviceField field(list, model, stream);
  const FieldContext& f = field.context();
  const KeyList candidates =
      candidate_bricks_on_device(f, options.memory_limit / sizeof(ActiveBrick), stream);
  marks.mark();
  advance(options.monitor, 1);
  const std::uint64_t kept = model.kind == FieldKind::vdw ? 0 : candidates.count * kBrickValues;
  require_device_memory(kept * sizeof(float), "the field in the surface bricks",
                        options.device_memory);
  const DeviceArray<float> values(kept, stream.get());
  ExtractOptions beside_field = options;
  beside_field.device_memory -= values.bytes();
  const BrickKernels kernels{
      [&](ActiveBrick* bricks, const BrickCounts& counts) {
        count_bricks_on_device(f, candidates.keys.data(), candidates.count, bricks, values.data(),
                               counts, stream);
      },
      [&](const CountedBricks& counted, const DeviceMeshView& mesh, unsigned long long* clamped) {
        emit_vertices_on_device(f, counted.list(), counted.totals.most_atoms, values.data(), mesh,
                                clamped, stream);
      }};
  mesh_bricks_on_device(candidates, model.grid.spacing, kernels, LabelWidth::one, beside_field,
                        result, marks, stream);
  return result;
}

}  // namespace vdwmesh
