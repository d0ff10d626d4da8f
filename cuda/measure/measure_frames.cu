// Measures frames whose balls are in device memory, and leaves the measures of the balls there. The
// sums need every measure on the host, so all are downloaded as well; what the host changed, the
// balls that it measured itself and those that were not to be measured, is changed on the device
// likewise.
#include <cmath>
#include <limits>

#include "cuda/measure/device_measures.cuh"
#include "cuda/memory/device.cuh"
#include "cuda/memory/device_result.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/on_device.hpp"
#include "cuda/spheres/device_frames.cuh"
#include "measures/batch_frames.hpp"
#include "measures/measured_spheres.hpp"

namespace vdwmesh {

struct CudaMeasures::Data : DeviceResult<DeviceArray<SphereMeasures>> {
  using DeviceResult::DeviceResult;
};

namespace {

constexpr unsigned kThreads = 256;

// A thread for each row that changes.
__global__ void replace_rows(const std::uint32_t* ids, const SphereMeasures* values,
                             std::uint64_t count, SphereMeasures* rows) {
  const std::uint64_t i = thread_index();
  if (i < count) rows[ids[i]] = values[i];
}

// A thread for each row: writes `nothing` to those of atoms that are not measured.
__global__ void clear_rows(const std::uint8_t* is_measured, std::uint64_t atoms,
                           std::uint64_t count, SphereMeasures nothing, SphereMeasures* rows) {
  const std::uint64_t i = thread_index();
  if (i < count && is_measured[i % atoms] == 0) rows[i] = nothing;
}

void replace(const std::vector<std::uint32_t>& ids, const std::vector<SphereMeasures>& per_sphere,
             const DeviceArray<SphereMeasures>& rows, const Stream& stream) {
  std::vector<SphereMeasures> values;
  values.reserve(ids.size());
  for (const std::uint32_t id : ids) values.push_back(per_sphere[id]);
  const DeviceArray<std::uint32_t> places = upload(ids.data(), ids.size(), stream);
  const DeviceArray<SphereMeasures> changed = upload(values.data(), values.size(), stream);
  launch("replace_rows", replace_rows, over(ids.size(), kThreads), stream, places.data(),
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

}  // namespace

CudaMeasures measure_on_device(std::vector<ExactUnion>& result, const DeviceFrames& frames,
                               const FrameOptions& options) {
  require_arcs(options.measures);
  const std::size_t atoms = frames.atoms(), count = frames.valid_frames();
  const MeasuredSpheres measured(atoms, options.measures.measured);
  const DeviceFrames::Data& balls = frames.data();
  const DeviceScope scope(balls.device);
  result.clear();
  DeviceArray<SphereMeasures> rows;
  if (count > 0) {
    begin_stage(options.measures.monitor, "exact union (arcs, CUDA)", 1);
    const std::vector<std::size_t> offsets = frame_offsets(count, atoms);
    BatchMeasures batch;
    measure::MeasuredBatch done = measure::measure_batch(batch,
                                                         {.spheres = balls.rows.data(),
                                                          .size = count * atoms,
                                                          .offsets = offsets,
                                                          .memory = MemorySpace::device},
                                                         balls.rows.data(), balls.work());
    rows = std::move(done.on_device.per_sphere);
    replace(done.redone, batch.per_sphere, rows, balls.work());
    clear_others(measured, atoms, rows, balls.work());
    split_batch(result, batch, atoms, options);
    advance(options.measures.monitor, 1);
  }
  balls.work().wait();
  return CudaMeasures(std::make_shared<const CudaMeasures::Data>(balls.device, std::move(rows)));
}

int CudaMeasures::device() const { return data_->device(); }
const SphereMeasures* CudaMeasures::rows() const { return data_->arrays().data(); }

}  // namespace vdwmesh
