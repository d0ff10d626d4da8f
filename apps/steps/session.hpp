// What the steps of a run share, as one argument: machine, progress, report and clock.
#pragma once

#include <tbb/global_control.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/monitor.hpp"
#include "options.hpp"
#include "report/report.hpp"
#include "steps/stopwatch.hpp"

namespace vdwmesh::apps {

// The machine that steps may use, the monitor to which they report progress, and the report into
// which they write their results. Sweeps and benchmarks have a session for every run.
struct Session {
  MachineOptions machine;
  Monitor* monitor = nullptr;  // may be null
  Report report;
  LapClock clock = {};

  // Ends a stage: adds to it the time since the stage before ended.
  void end_stage(Timing::Stage Timing::*stage) { add(report.timing.*stage, clock.lap()); }
};

// The session of a verb. While the object lives, the number of threads is limited and the progress
// bar is shown as the command line says. The clock starts with the object.
class VerbSession : public Session {
 public:
  explicit VerbSession(const MachineOptions& options);

  // Removes the bar from the terminal. To be called before text is printed.
  void end_progress();
  // Adds the warnings that the figures call for and the total time, prints the report and writes
  // its JSON where asked for.
  void deliver_report(const OutputOptions& output);
  // Ends the last stage. The time since the session began is the total of the report.
  void stop_watch();
  // Prints the text to standard output. If --quiet was given, or if standard output gets data
  // instead (a file named "-"), prints only the warnings, to standard error.
  void deliver_text(const OutputOptions& output, const std::function<std::string()>& text) const;

 private:
  std::optional<tbb::global_control> threads_;
  std::unique_ptr<Monitor> progress_;
};

// Prints each warning as one line on standard error.
void print_warnings(const std::vector<std::string>& warnings);

}  // namespace vdwmesh::apps
