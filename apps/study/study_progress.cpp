// Words the progress line of a study. The time left is reckoned from the weights of the runs that
// are finished, because runs take from milliseconds to minutes. Names of inputs are shown as every
// text of a file is, without control characters.
#include "study/study_progress.hpp"

#include <fmt/format.h>

#include <utility>

#include "report/printable.hpp"

namespace vdwmesh::apps {

std::string duration_text(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", seconds);
  if (seconds < 90 * 60) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

double time_of_rest(double elapsed, double finished, double total) {
  return elapsed * (total - finished) / finished;
}

void StudyProgress::begin_run(std::string name) {
  const std::lock_guard lock(mutex_);
  run_ = printable(std::move(name));
  stage_ = "start";
  draw();
}

void StudyProgress::end_run(double weight) {
  const std::lock_guard lock(mutex_);
  finished_ += weight;
  draw();
}

std::string StudyProgress::time_left() const {
  if (finished_ == 0) return "time left not known yet";
  return fmt::format("about {} left",
                     duration_text(time_of_rest(watch_.seconds(), finished_, total_)));
}

std::string StudyProgress::text() const {
  const double part = total_ > 0 ? 100 * finished_ / total_ : 100;
  return fmt::format("study {:3.0f} %, {}: {}, {}", part, time_left(), run_, stage_);
}

std::unique_ptr<StudyProgress> make_study_progress(Progress progress, double total_weight) {
  const auto line =
      shows_progress(progress) ? StudyProgress::Line::shown : StudyProgress::Line::hidden;
  return std::make_unique<StudyProgress>(line, total_weight);
}

}  // namespace vdwmesh::apps
