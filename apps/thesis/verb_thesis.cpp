// `vdwmesh bench thesis`: reruns the tables of the thesis and prints them beside the printed
// figures.
#include "command_line/command_line.hpp"
#include "output.hpp"
#include "session.hpp"
#include "thesis/thesis_bench.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {

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
