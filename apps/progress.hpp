// Progress on standard error: one line that is drawn anew.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "core/monitor.hpp"
#include "options.hpp"

namespace vdwmesh::apps {

// Whether a line is wanted: asked for, or standard error is a terminal.
bool shows_progress(Progress progress);

// Draws the line at the beginning of every stage, and at most ten times a second in between.
// Derived classes define the text of the line. The destructor removes the line.
class ProgressLine : public Monitor {
 public:
  enum class Line { shown, hidden };
  explicit ProgressLine(Line line) : line_(line) {}
  ~ProgressLine() override;
  void begin_stage(std::string_view name, std::uint64_t steps) override;
  void advance(std::uint64_t steps) override;
  bool cancelled() const override;

 protected:
  virtual std::string text() const = 0;
  void draw();  // precondition: mutex_ is locked

  std::mutex mutex_;
  std::string stage_;
  std::uint64_t steps_ = 0;  // of the stage
  std::atomic<std::uint64_t> done_{0};

 private:
  Line line_;
  std::chrono::steady_clock::time_point next_draw_{};
};

// Returns a progress bar if shows_progress() says that one is wanted, else null.
std::unique_ptr<Monitor> make_progress(Progress progress);

}  // namespace vdwmesh::apps
