// A parallel loop over unions that are measured side by side. For the sources of this folder.
#pragma once

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <string_view>
#include <utility>

#include "core/monitor.hpp"

namespace vdwmesh {

// The first exception of a parallel loop, kept until the loop has ended.
class FirstError {
 public:
  // Calls body(), whose exception is kept instead of leaving this call.
  template <class Body>
  void guard(const Body& body) {
    try {
      body();
    } catch (...) {
      keep(std::current_exception());
    }
  }
  bool is_there() const { return is_there_.load(std::memory_order_relaxed); }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void keep(std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = std::move(error);
    is_there_.store(true, std::memory_order_relaxed);
  }

  std::mutex mutex_;
  std::exception_ptr error_;
  std::atomic<bool> is_there_ = false;
};

// For the stages inside of a step of another one: they stop where that stops or another step of it
// failed, and their progress is not told.
class StepMonitor final : public Monitor {
 public:
  StepMonitor(const Monitor* outer, const FirstError& error) : outer_(outer), error_(error) {}
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override {
    return error_.is_there() || (outer_ != nullptr && outer_->cancelled());
  }

 private:
  const Monitor* outer_;
  const FirstError& error_;
};

// Calls measure(i, space, monitor) for every i in [0, count) on all cores. A thread that takes an i
// stays with it, and where fewer are left than there are threads, the others help inside of it. So
// a loop inside of measure() may be parallel and mostly runs on one thread. `space` is what
// the thread keeps from one i to the next; `monitor` is for the stages inside.
//
// No exception may leave the outer loop: TBB would stop the loops inside of the other steps, which
// then return as if they were done, and their callers would use what was never computed.
template <class Space, class Measure>
void for_each_union(std::size_t count, Monitor* monitor, const Measure& measure) {
  begin_stage(monitor, "exact unions", count);
  FirstError error;
  StepMonitor inside(monitor, error);
  tbb::enumerable_thread_specific<Space> spaces;
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    if (error.is_there()) return;
    error.guard([&] {
      Space& space = spaces.local();
      // A thread that waits for the end of its union must not begin another one in the same memory.
      tbb::this_task_arena::isolate([&] { measure(i, space, &inside); });
      advance(monitor, 1);
    });
  });
  error.rethrow();
}

}  // namespace vdwmesh
