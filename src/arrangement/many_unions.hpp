// A parallel loop over unions that are measured side by side. For the sources of this folder.
#pragma once

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/monitor.hpp"

namespace vdwmesh {

// For a stage inside of a step of another one: it can be stopped, and its progress is not told.
class StepMonitor final : public Monitor {
 public:
  explicit StepMonitor(const Monitor* outer) : outer_(outer) {}
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return outer_ != nullptr && outer_->cancelled(); }

 private:
  const Monitor* outer_;
};

// Calls measure(i, space, monitor) for every i in [0, count) on all cores. A thread that takes an i
// stays with it, and where fewer are left than there are threads, the others help inside of it. So
// a loop inside of measure() may be parallel and mostly runs on one thread. `space` is what
// the thread keeps from one i to the next; `monitor` is for the stages inside.
template <class Space, class Measure>
void for_each_union(std::size_t count, Monitor* monitor, const Measure& measure) {
  begin_stage(monitor, "exact unions", count);
  StepMonitor inside(monitor);
  tbb::enumerable_thread_specific<Space> spaces;
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    Space& space = spaces.local();
    // A thread that waits for the end of its union must not begin another one in the same memory.
    tbb::this_task_arena::isolate([&] { measure(i, space, &inside); });
    advance(monitor, 1);
  });
}

}  // namespace vdwmesh
