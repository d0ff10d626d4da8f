// Measures of the balls of a batch, and derivatives of their sums, from and to device memory.
#pragma once

#include <vector>

#include "cuda/measure/batch_cells.cuh"
#include "measures/arcs/face_rates.hpp"
#include "measures/exact_union.hpp"
#include "measures/union_measurer.hpp"

namespace vdwmesh::measure {

// Of a ball of the batch.
__device__ inline arcs::BallWeights weights_at(const BatchWeights& weights, std::uint32_t id) {
  return {weights.area != nullptr ? weights.area[id] : 1,
          weights.volume != nullptr ? weights.volume[id] : 1};
}

struct MeasureCounts {
  std::uint32_t doubtful;  // balls whose rows mean nothing
  std::uint32_t large;     // balls for which the first kernel had no room
  std::uint32_t rows_not_finite, weights_not_finite;  // of derivatives
};

struct DeviceMeasures {
  BatchCells cells;
  DeviceArray<SphereMeasures> per_sphere;  // in the order of the batch, Å² and Å³
  // In the order of the batch, and for each set the balls at a kink (UnionGradients::kink_spheres);
  // empty if nobody asks.
  DeviceArray<BallGradient> gradients;
  DeviceArray<std::uint64_t> kinks;
  // List places of the balls whose rows mean nothing, in no order: a check left a doubt, or the
  // device has no room for the ball.
  DeviceArray<ListPlace> doubtful;
  DeviceArray<MeasureCounts> counts;  // one
};

// With `weights`, whose arrays are in device memory, also the gradients. Throws as BatchCells does.
DeviceMeasures measure_on_device(const DeviceBatch& batch, const Stream& stream,
                                 const BatchWeights* weights = nullptr);

// The measures of a batch whose doubtful balls were measured on the host.
struct MeasuredBatch {
  DeviceMeasures on_device;                    // rows of the balls `redone` mean nothing
  std::vector<std::uint32_t> redone;           // indices in the batch
  std::vector<BallGradient> redone_gradients;  // theirs; empty if nobody asks
};

// Measures a batch into `result`. `spheres` are the batch's, in memory of the current device. With
// `weights`, which are there too, also the gradients, which stay there. Returns when the stream has
// done its work. Throws as UnionMeasurer does.
MeasuredBatch measure_batch(BatchMeasures& result, const SphereBatch& batch, const Sphere* spheres,
                            const BatchWeights* weights, const Stream& stream);

}  // namespace vdwmesh::measure
