// Threads and progress of a run, for as long as it lives.
#pragma once

#include <tbb/global_control.h>

#include <memory>
#include <optional>

#include "core/monitor.hpp"
#include "options.hpp"
#include "progress.hpp"

namespace vdwmesh::apps {

class Machine {
 public:
  explicit Machine(const MachineOptions& options) : progress_(make_progress(options.progress)) {
    if (options.threads > 0) {
      threads_.emplace(tbb::global_control::max_allowed_parallelism,
                       static_cast<std::size_t>(options.threads));
    }
  }
  Monitor* monitor() const { return progress_.get(); }
  // Takes the bar off the terminal before text is printed.
  void end_progress() { progress_.reset(); }

 private:
  std::optional<tbb::global_control> threads_;
  std::unique_ptr<Monitor> progress_;
};

}  // namespace vdwmesh::apps
