// run_batch(): workers take structures from the source one by one and measure them. Rows wait in a
// window until those before them are there, so the order is that of the source. A worker that would
// get too far ahead of the oldest row waits, so the window, and the memory, are bounded.
#include "batch/batch.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <numeric>
#include <utility>

#include "batch/molecule_spheres.hpp"
#include "core/errors.hpp"

namespace vdwmesh {
namespace {

// Rows in the window for each worker. One slow structure holds up the others only when as many as
// this were measured beside it.
constexpr std::size_t kWindow = 16;

void describe_input(const Molecule& molecule, BatchRow& row) {
  row.atoms = molecule.atoms.size();
  row.left_out = molecule.skipped;
  row.guessed_elements = molecule.elements_guessed;
  row.warnings = molecule.warnings;
  row.assumed_radii = 0;
  for (const AssumedRadius& radius : molecule.radii_assumed) *row.assumed_radii += radius.count;
}

void describe_union(const ExactUnion& measured, BatchRow& row) {
  row.method = measured.method;
  row.area = measured.area;
  row.volume = measured.volume;
  if (measured.counts) {
    row.components = measured.counts->components;
    row.euler_characteristic = measured.counts->euler_characteristic;
  }
  if (measured.topology) {
    row.components = measured.topology->components;
    row.tunnels = measured.topology->tunnels;
    row.voids = measured.topology->voids;
    row.euler_characteristic = measured.topology->euler_characteristic;
  }
  row.fallback_spheres = measured.fallback_spheres;
  row.doubtful_spheres = measured.doubtful_spheres;
}

Molecule read(const NamedStructure& structure, const ReadOptions& options) {
  if (!structure.fault.empty()) throw FileFormatError(structure.fault);
  if (structure.bytes) return read_structure(structure.name, *structure.bytes, options);
  return read_structure(structure.name, options);
}

// Of one worker.
struct Space {
  Workspace workspace;
  ExactUnion measured;
};

void measure(const NamedStructure& structure, const BatchOptions& options, Space& space,
             BatchRow& row) {
  const Molecule molecule = read(structure, options.read);
  describe_input(molecule, row);
  const SphereSet spheres = to_spheres(molecule, options.probe);
  if (options.check) options.check(spheres);
  const auto chosen = measured_spheres(molecule);
  UnionOptions wanted;
  wanted.method = options.method;
  wanted.topology = options.topology;
  wanted.workspace = &space.workspace;
  if (chosen) wanted.measured = *chosen;
  exact_union_into(space.measured, spheres, wanted);
  describe_union(space.measured, row);
}

// Whatever one structure does, the others go on. An error leaves no measures behind.
BatchRow row_of(const NamedStructure& structure, const BatchOptions& options, Space& space) {
  BatchRow row;
  row.name = structure.name;
  try {
    measure(structure, options, space, row);
    return row;
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    row.error = error.what();
  } catch (const std::bad_alloc&) {
    row.error = "out of memory";
  } catch (const std::exception& error) {
    row.error = fmt::format("internal error: {}", error.what());
  }
  space.workspace.clear();  // may be half filled
  return row;
}

// The batch that the workers share.
class Batch {
 public:
  Batch(StructureSource& source, std::uint64_t most, const BatchOptions& options,
        const std::function<void(const BatchRow&)>& on_row, std::size_t workers)
      : source_(source),
        most_(most),
        options_(options),
        on_row_(on_row),
        window_(workers * kWindow) {}

  // What each worker does until there is nothing left.
  void work() {
    Space space;
    while (auto taken = take()) {
      // A worker that waits inside must not begin the work of another worker there: that one would
      // wait for the row of this one.
      tbb::this_task_arena::isolate([&] {
        try {
          give(taken->first, row_of(taken->second, options_, space));
        } catch (...) {
          stop(std::current_exception());
        }
      });
    }
  }

  std::uint64_t finish() {
    if (failure_) std::rethrow_exception(failure_);
    return emitted_;
  }

 private:
  using Numbered = std::pair<std::uint64_t, NamedStructure>;

  std::optional<Numbered> take() {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [this] { return ended_ || taken_ < emitted_ + window_.size(); });
    if (ended_ || taken_ == most_) return std::nullopt;
    try {
      if (std::optional<NamedStructure> found = source_.next(StructureSource::Content::read))
        return Numbered(taken_++, std::move(*found));
    } catch (...) {
      source_failure_ = std::current_exception();
    }
    most_ = taken_;  // the end of the source
    if (source_failure_ && emitted_ == taken_) fail(source_failure_);
    return std::nullopt;
  }

  // Puts the row into the window, and emits all rows that are next.
  void give(std::uint64_t number, BatchRow row) {
    const std::lock_guard lock(mutex_);
    window_[number % window_.size()] = std::move(row);
    while (!ended_) {
      std::optional<BatchRow>& oldest = window_[emitted_ % window_.size()];
      if (!oldest) break;
      on_row_(*oldest);
      oldest.reset();
      ++emitted_;
      advance(options_.monitor, 1);
    }
    if (source_failure_ && emitted_ == taken_) fail(source_failure_);
    room_.notify_all();
  }

  void stop(std::exception_ptr failure) {
    const std::lock_guard lock(mutex_);
    fail(std::move(failure));
  }

  void fail(std::exception_ptr failure) {  // mutex_ is locked
    if (!failure_) failure_ = std::move(failure);
    ended_ = true;
    room_.notify_all();
  }

  StructureSource& source_;
  std::uint64_t most_;
  const BatchOptions& options_;
  const std::function<void(const BatchRow&)>& on_row_;
  std::mutex mutex_;
  std::condition_variable room_;                 // in the window, or the end
  std::vector<std::optional<BatchRow>> window_;  // row i at index i modulo its size
  std::uint64_t taken_ = 0, emitted_ = 0;        // structures, rows
  bool ended_ = false;
  std::exception_ptr source_failure_;  // becomes failure_ when all rows before it are emitted
  std::exception_ptr failure_;
};

std::size_t workers_for(const BatchOptions& options) {
  if (options.threads > 0) return static_cast<std::size_t>(options.threads);
  return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
}

}  // namespace

BatchPart part_of(std::uint64_t part, std::uint64_t parts, std::uint64_t structures) {
  const auto begin = [&](std::uint64_t p) {
    return structures / parts * p + std::min(p, structures % parts);
  };
  return {begin(part), begin(part + 1) - begin(part)};
}

BatchRow measure_structure(const NamedStructure& structure, const BatchOptions& options) {
  Space space;
  return row_of(structure, options, space);
}

std::uint64_t run_batch(StructureSource& source, std::uint64_t most, const BatchOptions& options,
                        const std::function<void(const BatchRow&)>& on_row) {
  const std::size_t workers = workers_for(options);
  Batch batch(source, most, options, on_row, workers);
  tbb::parallel_for(std::size_t{0}, workers, [&](std::size_t) { batch.work(); });
  return batch.finish();
}

}  // namespace vdwmesh
