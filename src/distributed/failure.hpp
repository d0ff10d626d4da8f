// An exception as something that can be sent to another process: its class and its message.
#pragma once

#include <string>

namespace vdwmesh {

// The classes of core/errors.hpp that the program tells apart, and std::bad_alloc.
// DeviceMemoryExceeded is sent as its base class limit_exceeded.
enum class Cause : int {
  none,
  cancelled,
  invalid_input,
  file_format,
  backend_unavailable,
  limit_exceeded,
  out_of_memory,
  internal
};

struct Failure {
  Cause cause = Cause::none;
  std::string message;
};

// The exception that is being handled.
Failure current_failure();

// Throws the exception again. Precondition: there is one (Cause::none is none).
[[noreturn]] void throw_failure(const Failure& failure);

}  // namespace vdwmesh
