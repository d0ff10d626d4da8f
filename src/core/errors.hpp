// Exceptions by cause. The message is one line that says what, where, and what would work; it may
// name what stands in files and options, so control characters become question marks here.
#pragma once

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

// Options or data outside what the function's contract accepts.
class InvalidInput : public Error {
  using Error::Error;
};

// A file that cannot be opened, read, understood or written.
class FileFormatError : public Error {
  using Error::Error;
};

// The backend asked for is not in this build, or its device is not there.
class BackendUnavailable : public Error {
  using Error::Error;
};

// A CUDA call or kernel failed.
class CudaError : public Error {
  using Error::Error;
};

// The run needs more cells, vertices or bytes than allowed; thrown before they are taken.
class LimitExceeded : public Error {
  using Error::Error;
};

// The same of a device's memory: the host may have room.
class DeviceMemoryExceeded : public LimitExceeded {
  using LimitExceeded::LimitExceeded;
};

// The program contradicts itself: no input should be able to cause it.
class InternalError : public Error {
  using Error::Error;
};

// The caller's Monitor asked to stop.
class Cancelled : public Error {
  using Error::Error;
};

}  // namespace vdwmesh
