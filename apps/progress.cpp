// Draws progress lines: the cursor goes back to the beginning of the line, which is erased and
// written again. Stages are begun and advanced by any thread, so the line is locked while it is
// drawn, and a thread that finds it locked goes on with its work. The handler of signals knows
// whether a line stands open, so that an interrupted program ends it.
#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "interrupt.hpp"

namespace vdwmesh::apps {
namespace {

constexpr int kBarWidth = 30;
constexpr std::chrono::milliseconds kDrawInterval{100};

// An empty line is one that was taken off the terminal.
void replace_line(const std::string& text) {
  std::fputs(("\r\x1b[K" + text).c_str(), stderr);
  std::fflush(stderr);
  set_progress_line_open(!text.empty());
}

class ProgressBar : public ProgressLine {
 public:
  ProgressBar() : ProgressLine(Line::shown) {}

 private:
  std::string text() const override {
    const double part = static_cast<double>(done_) / static_cast<double>(steps_);
    const double shown = steps_ == 0 ? 1.0 : std::min(1.0, part);
    const int filled = static_cast<int>(shown * kBarWidth);
    return fmt::format("{:<12} [{:#<{}}{:.<{}}] {:3.0f} %", stage_, "", filled, "",
                       kBarWidth - filled, 100 * shown);
  }
};

}  // namespace

bool shows_progress(Progress progress) {
  return progress == Progress::always ||
         (progress == Progress::terminal_only && ::isatty(STDERR_FILENO) == 1);
}

ProgressLine::~ProgressLine() {
  if (line_ == Line::shown && !stage_.empty()) replace_line("");
}

void ProgressLine::begin_stage(std::string_view name, std::uint64_t steps) {
  const std::lock_guard lock(mutex_);
  stage_ = name;
  steps_ = steps;
  done_ = 0;
  draw();
}

void ProgressLine::advance(std::uint64_t steps) {
  done_ += steps;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock && std::chrono::steady_clock::now() >= next_draw_) draw();
}

bool ProgressLine::cancelled() const { return pending_signal() != 0; }

void ProgressLine::draw() {
  if (line_ == Line::hidden) return;
  replace_line(text());
  next_draw_ = std::chrono::steady_clock::now() + kDrawInterval;
}

std::unique_ptr<Monitor> make_progress(Progress progress) {
  return shows_progress(progress) ? std::make_unique<ProgressBar>() : nullptr;
}

}  // namespace vdwmesh::apps
