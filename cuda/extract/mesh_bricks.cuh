// From candidate bricks to a mesh on the device, for any kind of field.
#pragma once

#include <functional>

#include "cuda/extract/extract_stages.cuh"

namespace vdwmesh {

using CountKernel = std::function<void(ActiveBrick* bricks, const BrickCounts& counts)>;

// What differs between kinds of field.
struct BrickKernels {
  CountKernel count;
  std::function<void(const CountedBricks&, const DeviceMeshView&, unsigned long long* clamped)>
      emit_vertices;
};

// Counts the candidates and numbers what they hold; two marks.
CountedBricks count_and_scan(const KeyList& candidates, const CountKernel& count, StageMarks& marks,
                             const Stream& stream);

// Counts the candidates, numbers what they hold and emits it; throws LimitExceeded before it takes
// memory for the mesh, DeviceMemoryExceeded where more than options.device_memory would be taken
// beside the field. `marks` has one mark, made when the candidates were known.
void mesh_bricks_on_device(const KeyList& candidates, double spacing, const BrickKernels& kernels,
                           LabelWidth width, const ExtractOptions& options,
                           DeviceExtraction& result, StageMarks& marks, const Stream& stream);

}  // namespace vdwmesh
