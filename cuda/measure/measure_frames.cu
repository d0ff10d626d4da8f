// Measures sets and frames whose balls are in device memory, and leaves the measures of the balls,
// and their derivatives, there. The sums need every measure on the host, so all are downloaded;
// what the host changed, the balls that it measured itself and those that were not to be measured,
// is changed on the device likewise.
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "core/monitor.hpp"
#include "cuda/measure/device_measures.cuh"
#include "cuda/memory/device.cuh"
#include "cuda/memory/device_result.cuh"
#include "cuda/memory/fetch_values.cuh"
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
void replace(const std::vector<std::uint32_t>& ids, const std::vector<Row>& values,
             const DeviceArray<Row>& rows, const Stream& stream) {
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

SphereBatch batch_of(const DeviceFrames::Data& balls, std::span<const std::size_t> offsets) {
  return {.spheres = balls.rows.data(),
          .size = offsets.back(),
          .offsets = offsets,
          .memory = MemorySpace::device};
}

// The rows of sets, which stand one after another in the memory of `balls`; and with weights, for
// each set the balls at a kink.
BallRows rows_of(BatchMeasures& result, std::vector<std::uint64_t>& kinks,
                 const DeviceFrames::Data& balls, std::span<const std::size_t> offsets,
                 const BatchWeights* weights) {
  const Stream& stream = balls.work();
  measure::MeasuredBatch done =
      measure::measure_batch(result, batch_of(balls, offsets), balls.rows.data(), weights, stream);
  measure::DeviceMeasures& left = done.on_device;
  std::vector<SphereMeasures> redone;
  redone.reserve(done.redone.size());
  for (const std::uint32_t id : done.redone) redone.push_back(result.per_sphere[id]);
  replace(done.redone, redone, left.per_sphere, stream);
  if (weights != nullptr) {
    replace(done.redone, done.redone_gradients, left.gradients, stream);
    kinks = fetch_values(left.kinks.data(), left.kinks.size(), stream);
  }
  return {std::move(left.per_sphere), std::move(left.gradients)};
}

// Weights of the atoms of one frame, repeated for every frame.
class RepeatedWeights {
 public:
  RepeatedWeights(const BatchWeights& once, const DeviceFrames& frames, const Stream& stream)
      : weights_(once) {
    if (frames.valid_frames() == 1) return;
    repeat(weights_.area, area_, frames, stream);
    repeat(weights_.volume, volume_, frames, stream);
  }
  const BatchWeights& all() const { return weights_; }

 private:
  static void repeat(const double*& weights, DeviceArray<double>& copies,
                     const DeviceFrames& frames, const Stream& stream) {
    if (weights == nullptr) return;
    const std::size_t atoms = frames.atoms();
    copies = DeviceArray<double>(frames.valid_frames() * atoms, stream);
    for (std::size_t first = 0; first < copies.size(); first += atoms) {
      check_cuda(cudaMemcpyAsync(copies.data() + first, weights, atoms * sizeof(double),
                                 cudaMemcpyDeviceToDevice, stream.get()),
                 "weights");
    }
    weights = copies.data();
  }

  BatchWeights weights_;
  DeviceArray<double> area_, volume_;
};

BallRows measured_rows(std::vector<ExactUnion>& result, const DeviceFrames& frames,
                       const FrameOptions& options) {
  const DeviceFrames::Data& balls = frames.data();
  BatchMeasures batch;
  std::vector<std::uint64_t> none;
  BallRows rows =
      rows_of(batch, none, balls, frame_offsets(frames.valid_frames(), frames.atoms()), nullptr);
  const MeasuredSpheres measured(frames.atoms(), options.measures.measured);
  clear_others(measured, frames.atoms(), rows.measures, balls.work());
  split_batch(result, batch, frames.atoms(), options);
  return rows;
}

BallRows differentiated_rows(std::vector<ExactUnion>& result, std::vector<std::uint64_t>& kinks,
                             const DeviceFrames& frames, const BatchWeights& weights,
                             const FrameOptions& options) {
  const DeviceFrames::Data& balls = frames.data();
  const RepeatedWeights repeated(weights, frames, balls.work());
  BatchMeasures batch;
  BallRows rows = rows_of(batch, kinks, balls, frame_offsets(frames.valid_frames(), frames.atoms()),
                          &repeated.all());
  split_batch(result, batch, frames.atoms(), options);
  return rows;
}

// What `make_rows` makes, on the device of the balls.
template <class MakeRows>
CudaMeasures left_there(const DeviceFrames& frames, Monitor* monitor, const MakeRows& make_rows) {
  const DeviceFrames::Data& balls = frames.data();
  const DeviceScope scope(balls.device);
  begin_stage(monitor, "exact union (arcs, CUDA)", 1);
  BallRows rows = make_rows();
  advance(monitor, 1);
  balls.work().wait();
  return CudaMeasures(std::make_shared<const CudaMeasures::Data>(balls.device, std::move(rows)));
}

}  // namespace

CudaMeasures measure_on_device(std::vector<ExactUnion>& result, const DeviceFrames& frames,
                               const FrameOptions& options) {
  const MeasuredSpheres checked(frames.atoms(),
                                options.measures.measured);  // throws for what is no atom
  require_arcs(options.measures);
  result.clear();
  return left_there(frames, options.measures.monitor, [&] {
    return frames.valid_frames() > 0 ? measured_rows(result, frames, options) : BallRows{};
  });
}

CudaMeasures gradients_on_device(std::vector<ExactUnion>& result,
                                 std::vector<std::uint64_t>& kink_spheres,
                                 const DeviceFrames& frames, const BatchWeights& weights,
                                 const FrameOptions& options) {
  if (options.measures.measured) {
    throw InvalidInput("derivatives are of sums over all atoms, not over some of them");
  }
  require_arcs(options.measures);
  result.clear();
  kink_spheres.clear();
  return left_there(frames, options.measures.monitor, [&] {
    if (frames.valid_frames() == 0) return BallRows{};
    return differentiated_rows(result, kink_spheres, frames, weights, options);
  });
}

CudaMeasures sets_on_device(BatchMeasures& result, std::vector<std::uint64_t>& kink_spheres,
                            const DeviceFrames& balls, std::span<const std::size_t> offsets,
                            const BatchWeights* weights, Monitor* monitor) {
  if (balls.valid_frames() == 0) throw *balls.invalid();
  check_sets({.size = balls.atoms(), .offsets = offsets});
  return left_there(balls, monitor,
                    [&] { return rows_of(result, kink_spheres, balls.data(), offsets, weights); });
}

int CudaMeasures::device() const { return data_->device(); }
const SphereMeasures* CudaMeasures::rows() const { return data_->arrays().measures.data(); }
const BallGradient* CudaMeasures::gradients() const { return data_->arrays().gradients.data(); }

}  // namespace vdwmesh
