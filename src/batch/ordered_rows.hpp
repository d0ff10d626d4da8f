// One row for each structure of a source, made side by side and given out in order. Workers take
// structures from the source one by one and make their rows. Rows wait in a window until those
// before them are there, so the order is that of the source. A worker that would get too far ahead
// of the oldest row waits, so the window, and the memory, are bounded.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "batch/structure_source.hpp"
#include "core/monitor.hpp"

namespace vdwmesh {

// The work of a run. Row is the type of a row.
template <class Row>
struct RowWork {
  // Makes the row of a structure: called by any thread, for several structures at the same time.
  // The number of the worker, from 0, says which of the workers it is, so that each can keep
  // memory. What it throws ends the run.
  std::function<Row(const NamedStructure& structure, std::size_t worker)> make;
  // Takes the rows in the order of the source, one at a time.
  std::function<void(const Row& row)> take;
};

// The rows that the workers share.
template <class Row>
class OrderedRows {
 public:
  // Rows of the next structures of the source, up to `most`.
  OrderedRows(StructureSource& source, std::uint64_t most, const RowWork<Row>& work,
              std::size_t workers, Monitor* monitor)
      : source_(source), most_(most), work_(work), window_(workers * kWindow), monitor_(monitor) {}

  // What each worker does until there is nothing left.
  void run(std::size_t worker) {
    while (auto taken = next()) {
      // A worker that waits inside must not begin the work of another worker there: that one would
      // wait for the row of this one.
      tbb::this_task_arena::isolate([&] {
        try {
          give(taken->first, work_.make(taken->second, worker));
        } catch (...) {
          stop(std::current_exception());
        }
      });
    }
  }

  // The number of rows, when all workers are done. Throws what ended the run.
  std::uint64_t finish() {
    if (failure_) std::rethrow_exception(failure_);
    return emitted_;
  }

 private:
  // Rows in the window for each worker. One slow structure holds up the others only when as many as
  // this were measured beside it.
  static constexpr std::size_t kWindow = 16;

  using Numbered = std::pair<std::uint64_t, NamedStructure>;

  std::optional<Numbered> next() {
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

  // Puts the row into the window, and gives out all rows that are next.
  void give(std::uint64_t number, Row row) {
    const std::lock_guard lock(mutex_);
    window_[number % window_.size()] = std::move(row);
    while (!ended_) {
      std::optional<Row>& oldest = window_[emitted_ % window_.size()];
      if (!oldest) break;
      work_.take(*oldest);
      oldest.reset();
      ++emitted_;
      advance(monitor_, 1);
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
  const RowWork<Row>& work_;
  std::mutex mutex_;
  std::condition_variable room_;            // in the window, or the end
  std::vector<std::optional<Row>> window_;  // row i at index i modulo its size
  Monitor* monitor_;
  std::uint64_t taken_ = 0, emitted_ = 0;  // structures, rows
  bool ended_ = false;
  std::exception_ptr source_failure_;  // becomes failure_ when all rows before it are emitted
  std::exception_ptr failure_;
};

// Makes the rows of the next structures, up to `most`, with so many workers. Returns their number.
// Throws what the source and work.take() throw, after the rows before it.
template <class Row>
std::uint64_t make_rows(StructureSource& source, std::uint64_t most, const RowWork<Row>& work,
                        std::size_t workers, Monitor* monitor) {
  OrderedRows<Row> rows(source, most, work, workers, monitor);
  tbb::parallel_for(std::size_t{0}, workers, [&](std::size_t worker) { rows.run(worker); });
  return rows.finish();
}

}  // namespace vdwmesh
