// The exceptions of the library, one class for each cause.
//
// A message is one line. It says what is wrong, at which place of the input, and what would work.
// The program maps each class to an exit code (apps/main.cpp). A message may quote text from files
// and options, so control characters become question marks; they cannot break the line or send
// commands to a terminal.
#pragma once

#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace vdwmesh {

class Error : public std::runtime_error {
 public:
  explicit Error(std::string message) : std::runtime_error(without_controls(std::move(message))) {}

 private:
  static std::string without_controls(std::string text) {
    for (char& c : text) {
      if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
    }
    return text;
  }
};

// An option or argument violates the contract of the function.
class InvalidInput : public Error {
  using Error::Error;
};

// A file cannot be opened, read, understood or written.
class FileFormatError : public Error {
  using Error::Error;
};

// The requested backend is not part of this build, or the machine has no device for it.
class BackendUnavailable : public Error {
  using Error::Error;
};

// A CUDA call or kernel failed.
class CudaError : public Error {
  using Error::Error;
};

// The run needs more cells, vertices or bytes than the limits allow. It is thrown before the memory
// is allocated.
class LimitExceeded : public Error {
  using Error::Error;
};

// A memory limit, in bytes, that no run can exceed.
inline constexpr std::uint64_t kNoMemoryLimit = std::numeric_limits<std::uint64_t>::max();

// The run needs more memory than the CUDA device has. The same run may still fit the host's memory.
class DeviceMemoryExceeded : public LimitExceeded {
  using LimitExceeded::LimitExceeded;
};

// An internal consistency check failed. No input should be able to cause this error.
class InternalError : public Error {
  using Error::Error;
};

// The caller's Monitor asked the library to stop.
class Cancelled : public Error {
  using Error::Error;
};

}  // namespace vdwmesh
