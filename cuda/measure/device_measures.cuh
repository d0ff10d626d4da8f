// Measures of the balls of a batch, from and to device memory.
#pragma once

#include <vector>

#include "cuda/measure/batch_cells.cuh"
#include "measures/exact_union.hpp"
#include "measures/union_measurer.hpp"

namespace vdwmesh::measure {

struct DeviceMeasures {
  BatchCells cells;
  DeviceArray<SphereMeasures> per_sphere;  // in the order of the batch, Å² and Å³
  // List places of the balls whose measures mean nothing, counts[0] of them in no order: a check
  // left a doubt, or the device has no room for the ball.
  DeviceArray<ListPlace> doubtful;
  // [1]: balls for which the first kernel had no room.
  DeviceArray<std::uint32_t> counts;
};

// Throws as BatchCells does.
DeviceMeasures measure_on_device(const DeviceBatch& batch, const Stream& stream);

// The measures of a batch whose doubtful balls were measured on the host.
struct MeasuredBatch {
  DeviceMeasures on_device;           // rows of the balls `redone` mean nothing
  std::vector<std::uint32_t> redone;  // indices in the batch
};

// Measures a batch into `result`. `spheres` are the batch's, in memory of the current device.
// Returns when the stream has done its work. Throws as UnionMeasurer does.
MeasuredBatch measure_batch(BatchMeasures& result, const SphereBatch& batch, const Sphere* spheres,
                            const Stream& stream);

}  // namespace vdwmesh::measure
