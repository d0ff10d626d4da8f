// What the steps of a run share, so that each is handed one thing.
#pragma once

#include <tbb/global_control.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/monitor.hpp"
#include "options.hpp"
#include "report.hpp"
#include "stopwatch.hpp"

namespace vdwmesh::apps {

// The machine that steps may use, whom they tell how far they are, and where they write what they
// found out. Sweeps and benchmarks have one for every run.
struct Session {
  MachineOptions machine;
  Monitor* monitor = nullptr;  // may be null
  Report report;
  LapClock clock = {};

  // What ran since the last call belongs to this stage.
  void end_stage(Timing::Stage Timing::*stage) { add(report.timing.*stage, clock.lap()); }
};

// The session of a verb: it has the threads and the progress bar that the command line allows for
// as long as it lives, and measures the time.
class VerbSession : public Session {
 public:
  explicit VerbSession(const MachineOptions& options);

  // Takes the bar off the terminal, which has to be done before text is printed.
  void end_progress();
  // Adds the warnings that the figures call for and the total time, prints the report and writes
  // its JSON where asked for.
  void deliver_report(const OutputOptions& output);
  // Ends the last stage. The time since the session began is the total of the report.
  void stop_watch();
  // Prints the text where it is wanted, which is not where other output takes its place; else the
  // warnings go to standard error.
  void deliver_text(const OutputOptions& output, const std::function<std::string()>& text) const;

 private:
  std::optional<tbb::global_control> threads_;
  std::unique_ptr<Monitor> progress_;
};

// One line each on standard error.
void print_warnings(const std::vector<std::string>& warnings);

}  // namespace vdwmesh::apps
