// measure_frames(): exact_union() for each frame, with memory that each thread keeps, or one batch
// for a UnionMeasurer.
//
// An exception that concerns one frame waits until all frames were tried, so that the frame that is
// reported, and the results before it, do not depend on the order in which threads come to them.
#include "measures/frame_measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <mutex>
#include <utility>

#include "core/workspace.hpp"
#include "measures/batch_frames.hpp"
#include "measures/many_unions.hpp"
#include "measures/measured_spheres.hpp"
#include "measures/total_measures.hpp"
#include "spheres/check_sphere.hpp"

namespace vdwmesh {
namespace {

template <class Number>
double value_at(const std::byte* place) {
  Number value;
  std::memcpy(&value, place, sizeof value);
  return static_cast<double>(value);
}

// Writes the centres of a frame, in Å, to centers[0] and so on.
template <class Number>
void read_numbers(const FrameCoordinates& frames, std::size_t frame, std::vector<Vec3d>& centers) {
  const std::byte* atom = frames.first + static_cast<std::ptrdiff_t>(frame) * frames.frame_stride;
  for (Vec3d& center : centers) {
    for (int axis = 0; axis < 3; ++axis) {
      center[axis] = frames.unit * value_at<Number>(atom + axis * frames.axis_stride);
    }
    atom += frames.atom_stride;
  }
}

InvalidFrame not_finite(const Vec3d& c, std::size_t frame, std::size_t atom) {
  return {frame, atom,
          fmt::format("({}, {}, {}) is not finite; coordinates are in angstrom", c.x, c.y, c.z)};
}

void require_finite_centers(const std::vector<Vec3d>& centers, std::size_t frame) {
  for (std::size_t i = 0; i < centers.size(); ++i) {
    const Vec3d& c = centers[i];
    if (std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z)) continue;
    throw not_finite(c, frame, i);
  }
}

void read_frame(const FrameCoordinates& frames, std::size_t frame, std::vector<Vec3d>& centers) {
  centers.resize(frames.atoms);
  if (frames.type == CoordinateType::float32) {
    read_numbers<float>(frames, frame, centers);
  } else {
    read_numbers<double>(frames, frame, centers);
  }
  require_finite_centers(centers, frame);
}

std::vector<Sphere> at_origin(std::span<const double> radii) {
  std::vector<Sphere> spheres;
  spheres.reserve(radii.size());
  for (const double radius : radii) spheres.push_back({{0, 0, 0}, radius});
  return spheres;
}

// What a thread keeps from one frame to the next.
struct FrameSpace {
  Workspace workspace;
  std::vector<Vec3d> centers;
  SphereSet spheres;
  ExactUnion measured;
};

// The first frame that cannot be measured, of those that threads reported.
class FirstInvalid {
 public:
  void report(const InvalidFrame& error) {
    const std::lock_guard lock(mutex_);
    if (!first_ || error.frame() < first_->frame()) first_ = error;
  }
  std::size_t frames_before(std::size_t frames) const { return first_ ? first_->frame() : frames; }
  void rethrow() const {
    if (first_) throw InvalidFrame(*first_);
  }

 private:
  std::mutex mutex_;
  std::optional<InvalidFrame> first_;
};

// Runs work(), and reports input that is refused.
template <class Work>
void report_invalid(std::size_t frame, FirstInvalid& invalid, const Work& work) {
  try {
    work();
  } catch (const InvalidFrame& error) {
    invalid.report(error);
  } catch (const InvalidInput& error) {
    invalid.report({frame, std::nullopt, error.what()});
  }
}

// Measures the balls of the space where they are.
void measure_here(ExactUnion& result, FrameSpace& space, const FrameOptions& options,
                  Monitor* monitor) {
  UnionOptions measures = options.measures;
  measures.monitor = monitor;
  measures.workspace = &space.workspace;
  ExactUnion& measured = space.measured;
  exact_union_into(measured, space.spheres, measures);
  if (measures.topology == TopologyRequest::counts && !measured.counts) {
    measured.counts = exact_union(space.spheres, {UnionMethod::cgal, monitor}).counts;
  }
  // The memory of per_sphere stays here, unless it is part of the result.
  std::vector<SphereMeasures> per_sphere;
  if (options.per_sphere == PerSphere::drop) std::swap(per_sphere, measured.per_sphere);
  std::swap(result, measured);
  if (options.per_sphere == PerSphere::drop) {
    result.per_sphere.clear();
    std::swap(per_sphere, measured.per_sphere);
  }
}

void measure_on_cpu(std::vector<ExactUnion>& result, std::span<const double> radii,
                    const FrameCoordinates& frames, const FrameOptions& options) {
  const SphereSet balls(at_origin(radii));
  FirstInvalid invalid;
  for_each_union<FrameSpace>(frames.frames, options.measures.monitor,
                             [&](std::size_t frame, FrameSpace& space, Monitor* monitor) {
                               report_invalid(frame, invalid, [&] {
                                 read_frame(frames, frame, space.centers);
                                 if (space.spheres.empty()) space.spheres = balls;
                                 space.spheres.move_to(space.centers);
                                 measure_here(result[frame], space, options, monitor);
                               });
                             });
  result.resize(invalid.frames_before(frames.frames));
  invalid.rethrow();
}

// The rows of some frames, one after another.
std::vector<Sphere> rows_of(std::span<const double> radii, const FrameCoordinates& frames,
                            std::size_t first, std::size_t count, FirstInvalid& invalid) {
  std::vector<Sphere> rows(count * frames.atoms);
  for_each_union<FrameSpace>(count, nullptr, [&](std::size_t k, FrameSpace& space, Monitor*) {
    report_invalid(first + k, invalid, [&] {
      read_frame(frames, first + k, space.centers);
      const std::span place(&rows[k * frames.atoms], frames.atoms);
      for (std::size_t i = 0; i < place.size(); ++i) place[i] = {space.centers[i], radii[i]};
      SphereSet::view(place);  // checks them
    });
  });
  return rows;
}

ExactUnion part_of(const BatchMeasures& batch, std::size_t first, const MeasuredSpheres& measured,
                   std::size_t atoms, PerSphere per_sphere) {
  constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
  ExactUnion part{};
  part.method = UnionMethod::arcs;
  const auto begin = batch.per_sphere.begin() + static_cast<std::ptrdiff_t>(first);
  part.per_sphere.assign(begin, begin + static_cast<std::ptrdiff_t>(atoms));
  for (std::size_t i = 0; i < atoms; ++i) {
    if (measured.contains(static_cast<SphereId>(i))) continue;
    part.per_sphere[i] = {kNotMeasured, kNotMeasured};
  }
  const SphereMeasures total = total_measures(part.per_sphere, measured);
  part.area = total.area;
  part.volume = total.volume;
  if (per_sphere == PerSphere::drop) part.per_sphere = {};
  return part;
}

// Adds the measures of some frames to the result, up to the first that cannot be measured.
void measure_part(std::vector<ExactUnion>& result, std::span<const double> radii,
                  const FrameCoordinates& frames, std::size_t first, std::size_t most,
                  const FrameOptions& options, FirstInvalid& invalid) {
  const std::vector<Sphere> rows = rows_of(radii, frames, first, most, invalid);
  const std::size_t count = invalid.frames_before(first + most) - first;
  if (count == 0) return;
  const std::vector<std::size_t> offsets = frame_offsets(count, frames.atoms);
  const BatchMeasures batch = options.measurer->measure(
      {.spheres = rows.data(), .size = count * frames.atoms, .offsets = offsets},
      options.measures.monitor);
  std::vector<ExactUnion> part;
  split_batch(part, batch, frames.atoms, options);
  std::ranges::move(part, std::back_inserter(result));
  if (first > 0) result[0].fallback_spheres += std::exchange(result[first].fallback_spheres, 0);
}

// The frames go to the measurer in parts that keep a device busy and take little memory.
void measure_by_batch(std::vector<ExactUnion>& result, std::span<const double> radii,
                      const FrameCoordinates& frames, const FrameOptions& options) {
  require_arcs(options.measures);
  const std::size_t most = std::max(options.balls_at_once / frames.atoms, std::size_t{1});
  FirstInvalid invalid;
  result.clear();
  for (std::size_t first = 0; first == result.size() && first < frames.frames; first += most) {
    measure_part(result, radii, frames, first, std::min(most, frames.frames - first), options,
                 invalid);
  }
  invalid.rethrow();
}

}  // namespace

void require_arcs(const UnionOptions& measures) {
  const bool arcs = method_for(measures.method, measures.topology) == UnionMethod::arcs;
  if (arcs && measures.topology == TopologyRequest::none && !measures.certify) return;
  throw InvalidInput("a batch gives areas and volumes by arcs: no topology, no certificate");
}

InvalidFrame invalid_ball(const Sphere& ball, std::size_t frame, std::size_t atom) {
  const Vec3d& c = ball.center;
  if (!std::isfinite(c.x) || !std::isfinite(c.y) || !std::isfinite(c.z)) {
    return not_finite(c, frame, atom);
  }
  try {
    check_sphere(ball, atom);
  } catch (const InvalidInput& error) {
    return {frame, std::nullopt, error.what()};
  }
  throw InternalError("a ball that was refused is a sphere");
}

std::vector<std::size_t> frame_offsets(std::size_t frames, std::size_t atoms) {
  std::vector<std::size_t> offsets;
  for (std::size_t frame = 0; frame <= frames; ++frame) offsets.push_back(frame * atoms);
  return offsets;
}

void split_batch(std::vector<ExactUnion>& result, const BatchMeasures& batch, std::size_t atoms,
                 const FrameOptions& options) {
  const MeasuredSpheres measured(atoms, options.measures.measured);
  result.resize(batch.per_sphere.size() / atoms);
  tbb::parallel_for(std::size_t{0}, result.size(), [&](std::size_t frame) {
    result[frame] = part_of(batch, frame * atoms, measured, atoms, options.per_sphere);
  });
  result[0].fallback_spheres = batch.fallback_spheres;
}

void measure_frames(std::vector<ExactUnion>& result, std::span<const double> radii,
                    const FrameCoordinates& frames, const FrameOptions& options) {
  if (frames.atoms == 0) throw InvalidInput("the union of an empty set of spheres is not defined");
  if (frames.atoms != radii.size()) {
    throw InvalidInput(
        fmt::format("{} radii for {} atoms; each atom needs one", radii.size(), frames.atoms));
  }
  result.resize(frames.frames);
  if (frames.frames == 0) return;
  if (options.measurer != nullptr) {
    measure_by_batch(result, radii, frames, options);
  } else {
    measure_on_cpu(result, radii, frames, options);
  }
}

}  // namespace vdwmesh
