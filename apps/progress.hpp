// Progress bars on standard error.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "core/monitor.hpp"
#include "options.hpp"

namespace vdwmesh::apps {

// One line, drawn anew at most ten times a second.
class ProgressBar : public Monitor {
 public:
  ~ProgressBar() override;
  void begin_stage(std::string_view name, std::uint64_t steps) override;
  void advance(std::uint64_t steps) override;
  bool cancelled() const override;

 private:
  void draw();
  void erase();

  std::mutex mutex_;
  std::string stage_;
  std::uint64_t steps_ = 0;
  std::atomic<std::uint64_t> done_{0};
  std::chrono::steady_clock::time_point next_draw_{};
};

// A bar where one is wanted: asked for, or standard error is a terminal. Else null.
std::unique_ptr<Monitor> make_progress(Progress progress);

}  // namespace vdwmesh::apps
