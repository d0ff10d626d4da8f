#pragma once

#include <chrono>
#include <ctime>

namespace vdwmesh::apps {

class Stopwatch {
 public:
  // Wall-clock seconds since construction.
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

class CpuWatch {
 public:
  // Processor seconds of all threads of this process since construction, the kernel's for it
  // included.
  double seconds() const { return now() - start_; }

 private:
  static double now() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  double start_ = now();
};

}  // namespace vdwmesh::apps
