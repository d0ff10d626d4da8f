// Measures of the balls of a batch, from and to device memory.
#pragma once

#include "arrangement/exact_union.hpp"
#include "cuda/measure/batch_cells.cuh"

namespace vdwmesh::measure {

struct DeviceMeasures {
  BatchCells cells;
  DeviceArray<SphereMeasures> per_sphere;  // in the order of the batch, Å² and Å³
  // List places of the balls whose measures mean nothing, counts[0] of them in no order: a check
  // left a doubt, or the device has no room for the ball.
  DeviceArray<std::uint32_t> doubtful;
  // [1]: balls for which the first kernel had no room.
  DeviceArray<std::uint32_t> counts;
};

// Throws as BatchCells does.
DeviceMeasures measure_on_device(const DeviceBatch& batch, const Stream& stream);

}  // namespace vdwmesh::measure
