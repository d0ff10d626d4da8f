// Sets a verb up and delivers what it found: the report as text for people, as JSON for programs,
// and warnings on standard error where nobody would see them in the text. The number of threads
// holds for the whole process, so there is one such session at a time.
#include "steps/session.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "progress.hpp"
#include "report/output.hpp"
#include "report/printable.hpp"

namespace vdwmesh::apps {

VerbSession::VerbSession(const MachineOptions& options)
    : Session{options, nullptr, {}, {}}, progress_(make_progress(options.progress)) {
  monitor = progress_.get();
  if (options.threads == 0) return;
  threads_.emplace(tbb::global_control::max_allowed_parallelism,
                   static_cast<std::size_t>(options.threads));
}

void VerbSession::end_progress() {
  monitor = nullptr;
  progress_.reset();
}

// What was done last counts as the stage `write`.
void VerbSession::stop_watch() {
  end_stage(&Timing::write);
  report.timing.total = clock.whole();
}

// The time is taken before anything is printed, so that it is the same in text and JSON.
void VerbSession::deliver_report(const OutputOptions& output) {
  end_progress();
  add_warnings(report);
  stop_watch();
  if (!output.json.empty()) write_output(output.json, to_json(report));
  deliver_text(output, [&] { return to_text(report, machine.verbosity); });
}

void VerbSession::deliver_text(const OutputOptions& output,
                               const std::function<std::string()>& text) const {
  // "-" sends data to standard output, where the text would spoil it.
  const bool has_data =
      output.json == "-" || output.per_atom == "-" || output.voids == "-" || output.csv == "-";
  if (machine.verbosity == Verbosity::quiet || has_data) return print_warnings(report.warnings);
  write_standard_output(text());
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) {
    fmt::print(stderr, "vdwmesh: warning: {}\n", printable(warning));
  }
}

}  // namespace vdwmesh::apps
