// `vdwmesh bench thesis` and `vdwmesh bench pipeline`: time what their rooms measure and print the
// tables. Progress is by rows of the thesis's tables, or by cases of the pipeline, so that the bar
// itself takes no time from what is measured.
#include <algorithm>

#include "command_line/command_line.hpp"
#include "output.hpp"
#include "pipeline/pipeline_bench.hpp"
#include "session.hpp"
#include "thesis/thesis_bench.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

// The warnings of all inputs, each once. An input is in several cases.
std::vector<std::string> warnings_of(const PipelineBench& bench) {
  std::vector<std::string> all;
  for (const PipelineCase& done : bench.cases) {
    for (const std::string& warning : done.warnings) {
      std::string text = done.input + ": " + warning;
      if (std::ranges::find(all, text) == all.end()) all.push_back(std::move(text));
    }
  }
  return all;
}

}  // namespace

// Warnings of the reader are printed before the table, not when they come up between its rows.
void run_pipeline_bench(const Options& options) {
  VerbSession session(options.machine);
  const PipelineBench bench = time_pipeline(options, [&](std::size_t done, std::size_t cases) {
    if (done == 0) begin_stage(session.monitor, "pipeline", cases);
    advance(session.monitor, done == 0 ? 0 : 1);
  });
  session.end_progress();
  print_warnings(warnings_of(bench));
  if (!options.output.csv.empty()) write_output(options.output.csv, pipeline_bench_csv(bench));
  if (!options.output.json.empty()) write_output(options.output.json, pipeline_bench_json(bench));
  session.deliver_text(options.output, [&] { return pipeline_bench_text(bench); });
}

void run_thesis_bench(const Options& options) {
  VerbSession session(options.machine);
  const ThesisBench bench = rerun_thesis(
      options.thesis, [&](std::size_t row, std::size_t rows, const ThesisBenchRow& next) {
        if (row == 0) begin_stage(session.monitor, "Table " + next.table, rows);
        advance(session.monitor, row == 0 ? 0 : 1);
      });
  session.end_progress();
  if (!options.output.csv.empty()) write_output(options.output.csv, thesis_bench_csv(bench));
  if (!options.output.json.empty()) write_output(options.output.json, thesis_bench_json(bench));
  session.deliver_text(options.output, [&] { return thesis_bench_text(bench); });
}

}  // namespace vdwmesh::apps
