// How a caller watches and stops long work. Stages call it from any thread.
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
  virtual void advance(std::uint64_t steps) = 0;
  virtual bool cancelled() const = 0;
};

inline void begin_stage(Monitor* monitor, std::string_view name, std::uint64_t steps) {
  if (monitor) monitor->begin_stage(name, steps);
}

// Throws Cancelled when the caller asked to stop.
inline void advance(Monitor* monitor, std::uint64_t steps) {
  if (!monitor) return;
  if (monitor->cancelled()) throw Cancelled("stopped on request");
  monitor->advance(steps);
}

}  // namespace vdwmesh
