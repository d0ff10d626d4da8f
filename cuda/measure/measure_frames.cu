// Measures frames whose balls are in device memory, and leaves the measures of the balls, and their
// derivatives, there. The sums need every measure on the host, so all are downloaded as well; what
// the host changed, the balls that it measured itself and those that were not to be measured, is
// changed on the device likewise.
#include <cmath>
#include <limits>

#include "core/monitor.hpp"
#include "cuda/measure/device_measures.cuh"
#include "cuda/memory/device.cuh"
#include "cuda/memory/device_result.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/on_device.hpp"
#include "cuda/spheres/device_frames.cuh"
#include "measures/batch_frames.hpp"
#include "measures/measured_spheres.hpp"

namespace vdwmesh {

namespace {

struct BallRows {
  DeviceArray<SphereMeasures> measures;
  DeviceArray<BallGradient> gradients;  // empty if nobody asked
  std::uint64_t kink_spheres = 0;

  void give_back_on(cudaStream_t stream) {
    measures.give_back_on(stream);
    gradients.give_back_on(stream);
  }
};

}  // namespace

struct CudaMeasures::Data : DeviceResult<BallRows> {
  using DeviceResult::DeviceResult;
};

namespace {

constexpr unsigned kThreads = 256;

// A thread for each row that changes.
template <class Row>
__global__ void replace_rows(const std::uint32_t* ids, const Row* values, std::uint64_t count,
                             Row* rows) {
  const std::uint64_t i = thread_index();
  if (i < count) rows[ids[i]] = values[i];
}

// A thread for each row: writes `nothing` to those of atoms that are not measured.
__global__ void clear_rows(const std::uint8_t* is_measured, std::uint64_t atoms,
                           std::uint64_t count, SphereMeasures nothing, SphereMeasures* rows) {
  const std::uint64_t i = thread_index();
  if (i < count && is_measured[i % atoms] == 0) rows[i] = nothing;
}

// Copies the rows of these balls from the host.
template <class Row>
void replace(const std::vector<std::uint32_t>& ids, const std::vector<Row>& on_host,
             const DeviceArray<Row>& rows, const Stream& stream) {
  std::vector<Row> values;
  values.reserve(ids.size());
  for (const std::uint32_t id : ids) values.push_back(on_host[id]);
  const DeviceArray<std::uint32_t> places = upload(ids.data(), ids.size(), stream);
  const DeviceArray<Row> changed = upload(values.data(), values.size(), stream);
  launch("replace_rows", replace_rows<Row>, over(ids.size(), kThreads), stream, places.data(),
         changed.data(), ids.size(), rows.data());
}

void clear_others(const MeasuredSpheres& measured, std::size_t atoms,
                  const DeviceArray<SphereMeasures>& rows, const Stream& stream) {
  if (measured.all()) return;
  std::vector<std::uint8_t> mask(atoms);
  for (std::size_t i = 0; i < atoms; ++i) mask[i] = measured.contains(static_cast<SphereId>(i));
  const DeviceArray<std::uint8_t> is_measured = upload(mask.data(), mask.size(), stream);
  constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
  launch("clear_rows", clear_rows, over(rows.size(), kThreads), stream, is_measured.data(), atoms,
         rows.size(), SphereMeasures{kNotMeasured, kNotMeasured}, rows.data());
}

SphereBatch batch_of(const DeviceFrames::Data& balls, const std::vector<std::size_t>& offsets) {
  return {.spheres = balls.rows.data(),
          .size = offsets.back(),
          .offsets = offsets,
          .memory = MemorySpace::device};
}

BallRows measured_rows(std::vector<ExactUnion>& result, const DeviceFrames& frames,
                       const FrameOptions& options) {
  const DeviceFrames::Data& balls = frames.data();
  const MeasuredSpheres measured(frames.atoms(), options.measures.measured);
  const std::vector<std::size_t> offsets = frame_offsets(frames.valid_frames(), frames.atoms());
  BatchMeasures batch;
  measure::MeasuredBatch done =
      measure::measure_batch(batch, batch_of(balls, offsets), balls.rows.data(), balls.work());
  BallRows rows{std::move(done.on_device.per_sphere), {}, 0};
  replace(done.redone, batch.per_sphere, rows.measures, balls.work());
  clear_others(measured, frames.atoms(), rows.measures, balls.work());
  split_batch(result, batch, frames.atoms(), options);
  return rows;
}

BallRows differentiated_rows(std::vector<ExactUnion>& result, const DeviceFrames& frames,
                             const BatchWeights& weights, const FrameOptions& options) {
  const DeviceFrames::Data& balls = frames.data();
  const std::vector<std::size_t> offsets = frame_offsets(frames.valid_frames(), frames.atoms());
  BatchGradients batch;
  measure::MeasuredBatch done = measure::measure_batch(batch, batch_of(balls, offsets),
                                                       balls.rows.data(), weights, balls.work());
  BallRows rows{std::move(done.on_device.per_sphere), std::move(done.on_device.gradients),
                batch.kink_spheres};
  replace(done.redone, batch.measures.per_sphere, rows.measures, balls.work());
  replace(done.redone, batch.per_sphere, rows.gradients, balls.work());
  split_batch(result, batch.measures, frames.atoms(), options);
  return rows;
}

// Rows by rows_of(), unless no frame is valid.
template <class RowsOf>
CudaMeasures left_there(std::vector<ExactUnion>& result, const DeviceFrames& frames,
                        const FrameOptions& options, const RowsOf& rows_of) {
  require_arcs(options.measures);
  const DeviceFrames::Data& balls = frames.data();
  const DeviceScope scope(balls.device);
  result.clear();
  BallRows rows;
  if (frames.valid_frames() > 0) {
    begin_stage(options.measures.monitor, "exact union (arcs, CUDA)", 1);
    rows = rows_of();
    advance(options.measures.monitor, 1);
  }
  balls.work().wait();
  return CudaMeasures(std::make_shared<const CudaMeasures::Data>(balls.device, std::move(rows)));
}

}  // namespace

CudaMeasures measure_on_device(std::vector<ExactUnion>& result, const DeviceFrames& frames,
                               const FrameOptions& options) {
  const MeasuredSpheres checked(frames.atoms(),
                                options.measures.measured);  // throws for what is no atom
  return left_there(result, frames, options,
                    [&] { return measured_rows(result, frames, options); });
}

CudaMeasures gradients_on_device(std::vector<ExactUnion>& result, const DeviceFrames& frames,
                                 const BatchWeights& weights, const FrameOptions& options) {
  if (options.measures.measured) {
    throw InvalidInput("derivatives are of sums over all atoms, not over some of them");
  }
  return left_there(result, frames, options,
                    [&] { return differentiated_rows(result, frames, weights, options); });
}

int CudaMeasures::device() const { return data_->device(); }
const SphereMeasures* CudaMeasures::rows() const { return data_->arrays().measures.data(); }
const BallGradient* CudaMeasures::gradients() const { return data_->arrays().gradients.data(); }
std::uint64_t CudaMeasures::kink_spheres() const { return data_->arrays().kink_spheres; }

}  // namespace vdwmesh
