// The progress line of a study: how far it is, and about how long it will still take.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "core/monitor.hpp"
#include "options.hpp"

namespace vdwmesh::apps {

// "50 s", "12 min", "3.5 h".
std::string duration_text(double seconds);

// Weights are in any unit that time is about proportional to.
class StudyProgress : public Monitor {
 public:
  enum class Line { shown, hidden };
  StudyProgress(Line line, double total_weight) : line_(line), total_(total_weight) {}
  ~StudyProgress() override;

  void begin_run(std::string name);
  void end_run(double weight);

  void begin_stage(std::string_view name, std::uint64_t steps) override;
  void advance(std::uint64_t steps) override;
  bool cancelled() const override;

 private:
  using Clock = std::chrono::steady_clock;
  void draw();
  std::string time_left() const;

  Line line_;
  double total_, done_ = 0;
  std::mutex mutex_;
  std::string run_, stage_;
  Clock::time_point start_ = Clock::now(), next_draw_{};
};

std::unique_ptr<StudyProgress> make_study_progress(Progress progress, double total_weight);

}  // namespace vdwmesh::apps
