#include "study/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

#include "interrupt.hpp"
#include "printable.hpp"

namespace vdwmesh::apps {
namespace {

constexpr std::chrono::milliseconds kDrawInterval{200};
constexpr const char* kEraseLine = "\r\x1b[K";

}  // namespace

std::string duration_text(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", seconds);
  if (seconds < 90 * 60) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

StudyProgress::~StudyProgress() {
  if (line_ == Line::hidden || run_.empty()) return;
  std::fputs(kEraseLine, stderr);
  std::fflush(stderr);
  set_progress_line_open(false);
}

void StudyProgress::begin_run(std::string name) {
  const std::lock_guard lock(mutex_);
  run_ = printable(std::move(name));
  stage_ = "start";
  draw();
}

void StudyProgress::end_run(double weight) {
  const std::lock_guard lock(mutex_);
  done_ += weight;
  draw();
}

void StudyProgress::begin_stage(std::string_view name, std::uint64_t /*steps*/) {
  const std::lock_guard lock(mutex_);
  stage_ = name;
  if (Clock::now() >= next_draw_) draw();
}

void StudyProgress::advance(std::uint64_t /*steps*/) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock && Clock::now() >= next_draw_) draw();
}

bool StudyProgress::cancelled() const { return pending_signal() != 0; }

std::string StudyProgress::time_left() const {
  if (done_ == 0) return "time left not known yet";
  const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
  return fmt::format("about {} left", duration_text(elapsed * (total_ - done_) / done_));
}

void StudyProgress::draw() {
  if (line_ == Line::hidden) return;
  const double part = total_ > 0 ? 100 * done_ / total_ : 100;
  std::fputs(
      fmt::format("{}study {:3.0f} %, {}: {}, {}", kEraseLine, part, time_left(), run_, stage_)
          .c_str(),
      stderr);
  std::fflush(stderr);
  set_progress_line_open(true);
  next_draw_ = Clock::now() + kDrawInterval;
}

std::unique_ptr<StudyProgress> make_study_progress(Progress progress, double total_weight) {
  const bool shown = progress == Progress::always ||
                     (progress == Progress::terminal_only && ::isatty(STDERR_FILENO) == 1);
  return std::make_unique<StudyProgress>(
      shown ? StudyProgress::Line::shown : StudyProgress::Line::hidden, total_weight);
}

}  // namespace vdwmesh::apps
