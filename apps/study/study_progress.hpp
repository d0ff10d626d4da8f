// The progress line of a study: how far it is, and about how long it will still take.
#pragma once

#include <memory>
#include <string>

#include "progress.hpp"
#include "steps/stopwatch.hpp"

namespace vdwmesh::apps {

// "50 s", "12 min", "3.5 h".
std::string duration_text(double seconds);

// How long the rest will take, in the unit of `elapsed`, if `finished` of `total` took that.
double time_of_rest(double elapsed, double finished, double total);

// Weights are in any unit that time is about proportional to.
class StudyProgress : public ProgressLine {
 public:
  StudyProgress(Line line, double total_weight) : ProgressLine(line), total_(total_weight) {}
  void begin_run(std::string name);
  void end_run(double weight);

 private:
  std::string text() const override;
  std::string time_left() const;

  double total_, finished_ = 0;
  std::string run_;
  Stopwatch watch_;
};

std::unique_ptr<StudyProgress> make_study_progress(Progress progress, double total_weight);

}  // namespace vdwmesh::apps
