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
constexpr const char* kEraseLine = "\r\x1b[K";

}  // namespace

ProgressBar::~ProgressBar() { erase(); }

void ProgressBar::begin_stage(std::string_view name, std::uint64_t steps) {
  const std::lock_guard lock(mutex_);
  stage_ = name;
  steps_ = steps;
  done_ = 0;
  draw();
}

void ProgressBar::advance(std::uint64_t steps) {
  done_ += steps;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock && std::chrono::steady_clock::now() >= next_draw_) draw();
}

bool ProgressBar::cancelled() const { return pending_signal() != 0; }

void ProgressBar::draw() {
  const double part =
      steps_ == 0 ? 1.0 : std::min(1.0, static_cast<double>(done_) / static_cast<double>(steps_));
  const int filled = static_cast<int>(part * kBarWidth);
  const std::string line = fmt::format("{}{:<12} [{:#<{}}{:.<{}}] {:3.0f} %", kEraseLine, stage_,
                                       "", filled, "", kBarWidth - filled, 100 * part);
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
  set_progress_line_open(true);
  next_draw_ = std::chrono::steady_clock::now() + kDrawInterval;
}

void ProgressBar::erase() {
  if (stage_.empty()) return;
  std::fputs(kEraseLine, stderr);
  std::fflush(stderr);
  set_progress_line_open(false);
}

std::unique_ptr<Monitor> make_progress(Progress progress) {
  const bool wanted = progress == Progress::always ||
                      (progress == Progress::terminal_only && ::isatty(STDERR_FILENO) == 1);
  return wanted ? std::make_unique<ProgressBar>() : nullptr;
}

}  // namespace vdwmesh::apps
