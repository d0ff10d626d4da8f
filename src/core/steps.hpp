// Counts the steps of a loop, and asks the monitor once for kPerQuestion of them. So whoever counts
// the questions counts the steps.
#pragma once

#include <cstddef>

#include "core/host_device.hpp"
#include "core/monitor.hpp"

namespace vdwmesh {

class Steps {
 public:
  static constexpr std::size_t kPerQuestion = 128;

  VDWMESH_HD explicit Steps(Monitor* monitor) : monitor_(monitor) {}
  // Throws Cancelled.
  void add(std::size_t steps) {
    if (!monitor_) return;
    for (since_ += steps; since_ >= kPerQuestion; since_ -= kPerQuestion) advance(monitor_, 0);
  }

 private:
  Monitor* monitor_;
  std::size_t since_ = 0;  // the last question
};

}  // namespace vdwmesh
