// The measurer of a CUDA device. measure_on_device() measures the balls; those that leave a doubt,
// or for which the device has no room, are measured on the host by a triangulation of them and
// their neighbours, which the device lists.
//
// A batch in memory of the host is measured in parts, each of whole sets: while the device measures
// one part, another travels to it and the results of a third travel back.
#include <cuda_runtime.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "cuda/cuda_backend.hpp"
#include "cuda/measure/batch_cells.cuh"
#include "cuda/measure/device_measures.cuh"
#include "cuda/measure/power_cell.cuh"
#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/device.cuh"
#include "cuda/memory/fetch_values.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/run_on_threads.hpp"
#include "cuda/memory/transfer.cuh"
#include "measures/arcs/arc_cap.hpp"
#include "measures/arcs/ball_gradient.hpp"
#include "measures/complex_faces.hpp"
#include "measures/reference_measures.hpp"
#include "measures/union_measurer.hpp"

namespace vdwmesh::measure {
namespace {

// A warp for each of `count` balls: finds the balls that overlap it, itself among them. Writes
// their number or, if `ids` is given, their indices from first[i] on, and the ball's own index.
__global__ void list_neighbors(BatchCellsView list, const ListPlace* places, std::uint32_t count,
                               const std::uint64_t* first, std::uint64_t* numbers,
                               std::uint32_t* own_ids, std::uint32_t* ids, Sphere* spheres) {
  const std::uint64_t i = thread_index() / 32;
  if (i >= count) return;
  const unsigned lane = threadIdx.x % 32;
  const ListPlace place = places[i];
  const Sphere ball = list.spheres[place];
  std::uint64_t found = 0;
  visit_near(list, ball, set_at(list, place), [&](ListPlace other, bool here) {
    bool near = false;
    if (here) {
      const Sphere s = list.spheres[other];
      const Vec3d to = s.center - ball.center;
      const double sum = ball.radius + s.radius;
      near = other == place || arcs::inner(to, to) < sum * sum;
    }
    const unsigned hits = __ballot_sync(kAllLanes, near);
    if (near && ids != nullptr) {
      const std::uint64_t to = first[i] + found + __popc(hits & lanes_before());
      ids[to] = list.id[other];
      spheres[to] = list.spheres[other];
    }
    found += __popc(hits);
    return false;
  });
  if (lane != 0) return;
  if (ids == nullptr) {
    numbers[i] = found;
  } else {
    own_ids[i] = list.id[place];
  }
}

// A thread for each of `count` list places: the index of its ball in the batch.
__global__ void name_balls(BatchCellsView list, const ListPlace* places, std::uint32_t count,
                           std::uint32_t* ids) {
  const std::uint64_t i = thread_index();
  if (i < count) ids[i] = list.id[places[i]];
}

// A thread for each of `count` balls: its weights.
__global__ void take_weights(const std::uint32_t* ids, std::uint64_t count, BatchWeights weights,
                             arcs::BallWeights* taken) {
  const std::uint64_t i = thread_index();
  if (i < count) taken[i] = weights_at(weights, ids[i]);
}

// Rows of the host, in the order of the batch; `kinks` has one for each set. Gradients and kinks
// are not brought to the host if there are none.
struct HostRows {
  std::span<SphereMeasures> per_sphere;
  std::span<BallGradient> gradients = {};
  std::span<std::uint64_t> kinks = {};
};

// The balls that the device leaves to the host, with the balls that overlap them.
struct HostWork {
  std::vector<std::uint32_t> ids;    // in the order of list places
  std::vector<std::uint64_t> first;  // by ball: where its neighbours begin; and the end
  std::vector<std::uint32_t> near_ids;
  std::vector<Sphere> near_spheres;
  std::vector<arcs::BallWeights> near_weights;  // if gradients are asked for
};

// Fills the rows of the wanted balls, and `gradients` with theirs. `weights` are those of all balls
// in `near`.
void differentiate_on_host(std::span<const SphereId> wanted, std::vector<NumberedBall> near,
                           const std::unordered_map<SphereId, arcs::BallWeights>& weights,
                           std::span<SphereMeasures> rows, std::span<BallGradient> gradients) {
  std::ranges::fill(gradients, BallGradient{});  // of a ball without a volume of its own
  FaceVisitor visitor;
  visitor.visit = [&](SphereId id, const Sphere& ball, double area, auto faces) {
    const BallGradient found = ball_gradient(ball, area, faces, weights.at(id),
                                             [&](SphereId other) { return weights.at(other); });
    require_finite_derivatives(is_finite(found));
    gradients[std::ranges::find(wanted, id) - wanted.begin()] = found;
  };
  visit_by_triangulation(wanted, std::move(near), rows, visitor);
}

// Measures balls begin up to end of the work, which are of one set, by one triangulation.
// `gradients` are those of the work, or none.
void measure_on_host(const HostWork& work, std::size_t begin, std::size_t end,
                     std::span<SphereMeasures> rows, std::span<BallGradient> gradients) {
  std::vector<NumberedBall> near;
  for (std::uint64_t i = work.first[begin]; i < work.first[end]; ++i) {
    near.push_back({work.near_ids[i], work.near_spheres[i]});
  }
  const auto wanted = std::span(work.ids).subspan(begin, end - begin);
  if (gradients.empty()) return set_reference_measures(wanted, std::move(near), rows);
  std::unordered_map<SphereId, arcs::BallWeights> weights;
  for (std::uint64_t i = work.first[begin]; i < work.first[end]; ++i) {
    weights.emplace(work.near_ids[i], work.near_weights[i]);
  }
  differentiate_on_host(wanted, std::move(near), weights, rows,
                        gradients.subspan(begin, end - begin));
}

// Brings the doubtful balls and their neighbours to the host.
HostWork host_work(const DeviceMeasures& measured, std::uint32_t count, const BatchWeights* weights,
                   const Stream& stream) {
  const BatchCellsView& list = measured.cells.view();
  std::vector<ListPlace> places = fetch_values(measured.doubtful.data(), count, stream);
  std::sort(places.begin(), places.end());
  const DeviceArray<ListPlace> sorted = upload(places.data(), count, stream.get());
  DeviceArray<std::uint64_t> first = zeros<std::uint64_t>(count + std::size_t{1}, stream);
  const LaunchShape shape = over(32 * std::uint64_t{count}, 128);
  launch("list_neighbors", list_neighbors, shape, stream, list, sorted.data(), count, nullptr,
         first.data(), nullptr, nullptr, nullptr);
  run_cub("neighbours", stream, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceScan::ExclusiveSum(scratch, bytes, first.data(), count + std::uint64_t{1},
                                         stream.get());
  });
  const std::uint64_t total = fetch(first.data() + count, stream);
  const DeviceArray<std::uint32_t> own_ids(count, stream), near_ids(total, stream);
  const DeviceArray<Sphere> near_spheres(total, stream);
  launch("list_neighbors", list_neighbors, shape, stream, list, sorted.data(), count, first.data(),
         nullptr, own_ids.data(), near_ids.data(), near_spheres.data());
  const DeviceArray<arcs::BallWeights> near_weights(weights != nullptr ? total : 0, stream);
  if (weights != nullptr) {
    launch("take_weights", take_weights, over(total, 256), stream, near_ids.data(), total, *weights,
           near_weights.data());
  }
  return {.ids = fetch_values(own_ids.data(), count, stream),
          .first = fetch_values(first.data(), first.size(), stream),
          .near_ids = fetch_values(near_ids.data(), total, stream),
          .near_spheres = fetch_values(near_spheres.data(), total, stream),
          .near_weights = fetch_values(near_weights.data(), near_weights.size(), stream)};
}

// Measures the work on the host. Its entries stand in the order of list places: those of a set
// together, and near each other those that are near in space. So a few neighbouring ones share a
// triangulation. The parts of a set begin at its first entry. The order of list places, and with it
// the last bits, may depend on the other sets of the batch or of its part.
void redo(const HostWork& work, const std::vector<std::uint32_t>& offsets,
          std::span<SphereMeasures> rows, std::span<BallGradient> gradients) {
  constexpr std::size_t kMostTogether = 64;
  const auto set_of = [&](std::uint32_t id) {
    return std::upper_bound(offsets.begin(), offsets.end(), id);
  };
  std::vector<std::size_t> part_begin{0};
  for (std::size_t i = 1; i < work.ids.size(); ++i) {
    const std::size_t begin = part_begin.back();
    if (i - begin == kMostTogether || set_of(work.ids[i]) != set_of(work.ids[begin])) {
      part_begin.push_back(i);
    }
  }
  part_begin.push_back(work.ids.size());
  tbb::parallel_for(std::size_t{1}, part_begin.size(), [&](std::size_t part) {
    measure_on_host(work, part_begin[part - 1], part_begin[part], rows, gradients);
  });
}

std::vector<std::uint32_t> offsets_of(const SphereBatch& batch) {
  std::vector<std::uint32_t> offsets;
  offsets.reserve(batch.set_count() + 1);
  for (std::size_t set = 0; set < batch.set_count(); ++set) {
    offsets.push_back(static_cast<std::uint32_t>(batch.set_begin(set)));
  }
  offsets.push_back(static_cast<std::uint32_t>(batch.size));
  return offsets;
}

// The measures of balls in memory of the current device, as it leaves them.
struct LeftMeasures {
  DeviceMeasures on_device;
  MeasureCounts counts;
};

// Measures the balls and brings their rows to the host. The counts are fetched first: a transfer of
// much memory keeps others waiting while it waits for the stream.
LeftMeasures measure_and_download(const HostRows& rows, const std::vector<std::uint32_t>& offsets,
                                  const Sphere* spheres, const BatchWeights* weights,
                                  const Stream& stream) {
  const DeviceArray<std::uint32_t> device_offsets =
      upload(offsets.data(), offsets.size(), stream.get());
  LeftMeasures left{measure_on_device({spheres, offsets.back(), device_offsets.data(),
                                       static_cast<std::uint32_t>(offsets.size() - 1)},
                                      stream, weights),
                    {}};
  left.counts = fetch(left.on_device.counts.data(), stream);
  if (left.counts.weights_not_finite > 0) {
    throw InvalidInput(
        "weights of areas or volumes: " + std::to_string(left.counts.weights_not_finite) +
        " of the balls have one that is not finite");
  }
  require_finite_derivatives(left.counts.rows_not_finite == 0);
  download_parts(
      {{rows.per_sphere.data(), left.on_device.per_sphere.data(), rows.per_sphere.size_bytes()},
       {rows.gradients.data(), left.on_device.gradients.data(), rows.gradients.size_bytes()},
       {rows.kinks.data(), left.on_device.kinks.data(), rows.kinks.size_bytes()}},
      stream);
  return left;
}

// Measures a batch whose spheres and weights are in memory of the current device, but for the
// totals.
MeasuredBatch measure_balls(const HostRows& rows, const SphereBatch& batch, const Sphere* spheres,
                            const BatchWeights* weights, const Stream& stream) {
  const std::vector<std::uint32_t> offsets = offsets_of(batch);
  auto [on_device, counts] = measure_and_download(rows, offsets, spheres, weights, stream);
  MeasuredBatch measured{.on_device = std::move(on_device)};
  if (counts.doubtful == 0) return measured;
  HostWork work = host_work(measured.on_device, counts.doubtful, weights, stream);
  std::vector<BallGradient>& gradients = measured.redone_gradients;
  if (weights != nullptr) gradients.resize(work.ids.size());
  redo(work, offsets, rows.per_sphere, gradients);
  for (std::size_t i = 0; i < gradients.size() && !rows.gradients.empty(); ++i) {
    rows.gradients[work.ids[i]] = gradients[i];
  }
  measured.redone = std::move(work.ids);
  return measured;
}

// Sets that stand one after another, from number `first` up to `end`.
struct SetRange {
  std::size_t first, end;

  // The rows of their balls, which begin at `ball`.
  HostRows of(const HostRows& rows, std::size_t ball, std::size_t balls) const {
    const HostRows own{rows.per_sphere.subspan(ball, balls)};
    if (rows.gradients.empty()) return own;
    return {own.per_sphere, rows.gradients.subspan(ball, balls),
            rows.kinks.subspan(first, end - first)};
  }
};

// Cuts a batch where a set ends, into parts of at least so many balls but for the last.
std::vector<SetRange> parts_of(const SphereBatch& batch) {
  constexpr std::size_t kBallsOfPart = std::size_t{1} << 18;
  std::vector<SetRange> parts;
  std::size_t first = 0;
  for (std::size_t set = 0; set < batch.set_count(); ++set) {
    const bool is_last = set + 1 == batch.set_count();
    if (!is_last && batch.set_end(set) - batch.set_begin(first) < kBallsOfPart) continue;
    parts.push_back({first, set + 1});
    first = set + 1;
  }
  return parts;
}

// Weights that were copied to the device.
struct UploadedWeights {
  DeviceArray<double> area, volume;

  UploadedWeights(const BatchWeights& weights, std::size_t first, std::size_t size,
                  const Stream& stream) {
    const auto copy = [&](const double* from) {
      return from != nullptr ? upload(from + first, size, stream) : DeviceArray<double>();
    };
    area = copy(weights.area);
    volume = copy(weights.volume);
  }
  BatchWeights there() const { return {area.data(), volume.data()}; }
};

// Uploads and measures the balls of some sets. Returns how many of them the host measured.
std::size_t measure_part(const HostRows& rows, const SphereBatch& batch,
                         const BatchWeights* weights, const SetRange& part, const Stream& stream) {
  const std::size_t first = batch.set_begin(part.first), size = batch.set_end(part.end - 1) - first;
  std::vector<std::size_t> offsets{0};
  for (std::size_t set = part.first; set < part.end; ++set) {
    offsets.push_back(batch.set_end(set) - first);
  }
  const Sphere* const spheres = batch.spheres + first;
  const DeviceArray<Sphere> uploaded(size, stream);
  upload_parts({{uploaded.data(), spheres, uploaded.bytes()}}, stream);
  const UploadedWeights copied(weights != nullptr ? *weights : BatchWeights{}, first, size, stream);
  const BatchWeights there = copied.there();
  const MeasuredBatch measured = measure_balls(
      part.of(rows, first, size), {.spheres = spheres, .size = size, .offsets = offsets},
      uploaded.data(), weights != nullptr ? &there : nullptr, stream);
  return measured.redone.size();
}

// Measures a batch in memory of the host. Two threads take its parts in turn, each with a stream of
// its own, so that the balls of one part travel while the device measures those of another. Returns
// how many balls the host measured.
std::uint64_t measure_from_host(const HostRows& rows, const SphereBatch& batch,
                                const BatchWeights* weights) {
  const std::vector<SetRange> parts = parts_of(batch);
  int device = 0;
  check_cuda(cudaGetDevice(&device), "device");
  std::atomic<std::size_t> next{0}, redone{0};
  const auto take_parts = [&](std::size_t) {
    check_cuda(cudaSetDevice(device), "device");
    const Stream stream;
    for (std::size_t i = next++; i < parts.size(); i = next++) {
      redone += measure_part(rows, batch, weights, parts[i], stream);
    }
  };
  try {
    run_on_threads(std::min<std::size_t>(parts.size(), 2), take_parts);
  } catch (const InvalidInput&) {
    // A part knows a bad sphere by its place in the part; this names its place in the batch.
    SphereSet::view({batch.spheres, batch.size});
    throw;
  }
  return redone;
}

// The rows of a result, made as many as the batch needs.
HostRows rows_for(BatchGradients& result, const SphereBatch& batch) {
  result.measures.per_sphere.resize(batch.size);
  result.per_sphere.resize(batch.size);
  result.kink_spheres.resize(batch.set_count());
  return {result.measures.per_sphere, result.per_sphere, result.kink_spheres};
}

void finish(BatchMeasures& result, const SphereBatch& batch, std::uint64_t redone) {
  result.fallback_spheres = redone;
  result.fallback.clear();
  sum_sets(result, batch);
}

class CudaUnionMeasurer final : public UnionMeasurer {
 public:
  void measure_into(BatchMeasures& result, const SphereBatch& batch,
                    Monitor* monitor) const override {
    check_sets(batch);
    const DeviceScope scope;
    begin_stage(monitor, "exact union (arcs, CUDA)", 1);
    if (batch.memory == MemorySpace::host) {
      result.per_sphere.resize(batch.size);
      finish(result, batch, measure_from_host({result.per_sphere}, batch, nullptr));
    } else {
      measure_batch(result, batch, batch.spheres, nullptr, Stream());
    }
    advance(monitor, 1);
  }

  void gradients_into(BatchGradients& result, const SphereBatch& batch, const BatchWeights& weights,
                      Monitor* monitor) const override {
    check_sets(batch);
    const DeviceScope scope;
    begin_stage(monitor, "gradients of the exact union (CUDA)", 1);
    const HostRows rows = rows_for(result, batch);
    std::uint64_t redone = 0;
    if (batch.memory == MemorySpace::host) {
      check_weights(weights_of(weights.area, batch), weights_of(weights.volume, batch), batch.size);
      redone = measure_from_host(rows, batch, &weights);
    } else {
      redone = measure_balls(rows, batch, batch.spheres, &weights, Stream()).redone.size();
    }
    finish(result.measures, batch, redone);
    advance(monitor, 1);
  }

 private:
  static std::span<const double> weights_of(const double* weights, const SphereBatch& batch) {
    return weights == nullptr ? std::span<const double>() : std::span(weights, batch.size);
  }
};

}  // namespace

MeasuredBatch measure_batch(BatchMeasures& result, const SphereBatch& batch, const Sphere* spheres,
                            const BatchWeights* weights, const Stream& stream) {
  result.per_sphere.resize(batch.size);
  MeasuredBatch measured = measure_balls({result.per_sphere}, batch, spheres, weights, stream);
  finish(result, batch, measured.redone.size());
  return measured;
}

}  // namespace vdwmesh::measure

namespace vdwmesh {

std::unique_ptr<UnionMeasurer> make_cuda_union_measurer() {
  return std::make_unique<measure::CudaUnionMeasurer>();
}

DeviceArcs measure_arcs_on_cuda(const SphereSet& spheres) {
  const DeviceScope scope;
  const Stream stream;
  const std::span<const Sphere> balls = spheres.spheres();
  const DeviceArray<Sphere> uploaded(balls.size(), stream);
  upload_parts({{uploaded.data(), balls.data(), uploaded.bytes()}}, stream);
  DeviceArcs arcs;
  arcs.per_sphere.resize(balls.size());
  const auto [measured, counts] = measure::measure_and_download(
      {arcs.per_sphere}, {0, static_cast<std::uint32_t>(balls.size())}, uploaded.data(), nullptr,
      stream);
  if (const std::uint32_t doubtful = counts.doubtful; doubtful > 0) {
    const DeviceArray<std::uint32_t> ids(doubtful, stream);
    launch("name_balls", measure::name_balls, over(doubtful, 256), stream, measured.cells.view(),
           measured.doubtful.data(), doubtful, ids.data());
    arcs.suspect = fetch_values(ids.data(), ids.size(), stream);
    std::ranges::sort(arcs.suspect);
  }
  return arcs;
}

}  // namespace vdwmesh
