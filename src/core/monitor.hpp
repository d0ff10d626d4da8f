// Progress reports and cancellation for long computations.
//
// A caller implements Monitor and passes a pointer to it; a null pointer means no reports. The
// stages call the functions below, from any thread and from several threads at once, so an
// implementation must be thread-safe.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/errors.hpp"

namespace vdwmesh {

class Monitor {
 public:
  virtual ~Monitor() = default;
  // A new stage of `steps` equal pieces of work begins.
  virtual void begin_stage(std::string_view name, std::uint64_t steps) = 0;
  // `steps` more pieces of the current stage are done.
  virtual void advance(std::uint64_t steps) = 0;
  // Returns whether the computation should stop. The function advance() below asks at every call.
  virtual bool cancelled() const = 0;
};

// Reports the beginning of a stage, if there is a monitor.
inline void begin_stage(Monitor* monitor, std::string_view name, std::uint64_t steps) {
  if (monitor) monitor->begin_stage(name, steps);
}

// Reports progress, if there is a monitor. Throws Cancelled if the caller asked to stop. With 0
// steps the call only gives the caller a chance to stop.
inline void advance(Monitor* monitor, std::uint64_t steps) {
  if (!monitor) return;
  if (monitor->cancelled()) throw Cancelled("stopped on request");
  monitor->advance(steps);
}

}  // namespace vdwmesh
