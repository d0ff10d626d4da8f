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

// What a stage took.
struct StageTime {
  double wall = 0;  // s
  double cpu = 0;   // s, of all threads of this process
};

// Cuts a run into stages without gaps, so that their times add up to the whole.
class LapClock {
 public:
  // The time since the last lap, or since construction.
  StageTime lap() {
    const StageTime now{wall_.seconds(), cpu_.seconds()};
    const StageTime since{now.wall - last_.wall, now.cpu - last_.cpu};
    last_ = now;
    return since;
  }
  // All laps together.
  StageTime whole() const { return last_; }

 private:
  Stopwatch wall_;
  CpuWatch cpu_;
  StageTime last_;
};

}  // namespace vdwmesh::apps
