// `vdwmesh bench pipeline`: times every stage from structure file to mesh file and prints the
// table.
#include <algorithm>
#include <utility>

#include "command_line/command_line.hpp"
#include "output.hpp"
#include "pipeline/pipeline_bench.hpp"
#include "session.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

// Of each input once, however many cases it is in.
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

}  // namespace vdwmesh::apps
