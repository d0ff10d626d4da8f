// vdwmesh-bench: the benchmarks that are made of the steps of `vdwmesh`.
//
//   vdwmesh-bench thesis --structures FOLDER [--table 4.1,...] [--entry 110D,...]
//     reruns Tables 4.1 to 4.5 of the thesis on its grids (docs/thesis.md)
//   vdwmesh-bench pipeline INPUT... [--spacing 0.5,0.25] [--subdivide N] [--distances on]
//     times every stage from structure file to mesh file, with bytes, peak memory and the floor
//
// Progress is by rows of the thesis's tables, or by cases of the pipeline, so that the bar itself
// takes no time from what is measured.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>

#include "command_line/names.hpp"
#include "command_line/parse.hpp"
#include "interrupt.hpp"
#include "memory.hpp"
#include "outcome.hpp"
#include "pipeline/pipeline_bench.hpp"
#include "report/output.hpp"
#include "request/memory_limit.hpp"
#include "steps/session.hpp"
#include "thesis/thesis_bench.hpp"

namespace vdwmesh::apps {
namespace {

// What the command line says, for both benchmarks.
struct BenchOptions {
  MachineOptions machine;
  std::string json, csv;  // files, or "-"
  ThesisBenchOptions thesis;
  PipelineBenchOptions pipeline;
  std::vector<std::string> paths, samples;
  int repeats = 3;
};

template <class T>
CLI::CheckedTransformer names_of_values() {
  std::vector<std::pair<std::string, T>> names;
  for (const std::string_view name : all_names<T>()) {
    names.emplace_back(name, value_named<T>("", std::string(name)));
  }
  return CLI::CheckedTransformer(names);
}

// What both benchmarks take.
void add_common_options(CLI::App& app, BenchOptions& o) {
  app.add_option("--repeat", o.repeats, "runs of which the fastest counts; long ones run once")
      ->check(CLI::Range(1, 1000));
  app.add_option("--threads", o.machine.threads, "CPU threads; all by default")
      ->check(CLI::Range(1, 4096));
  app.add_option("--json", o.json, "the figures as JSON; - is standard output");
  app.add_option("--csv", o.csv, "the table as CSV; - is standard output");
  app.add_flag_callback("--quiet", [&o] {
    o.machine.verbosity = Verbosity::quiet;
    o.machine.progress = Progress::never;
  });
  app.add_flag_callback("--progress", [&o] { o.machine.progress = Progress::always; });
}

void add_thesis_options(CLI::App& app, ThesisBenchOptions& o) {
  app.add_option("--structures", o.structures, "folder of the thesis's structure files")
      ->required();
  const std::vector<std::string> tables(kThesisTables.begin(), kThesisTables.end());
  app.add_option("--table", o.tables, "tables; all by default")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(tables));
  app.add_option("--entry", o.entries, "PDB ids of the tables; all by default")
      ->delimiter(',')
      ->allow_extra_args(false);
}

void add_pipeline_options(CLI::App& app, BenchOptions& o) {
  PipelineBenchOptions& p = o.pipeline;
  app.add_option("INPUT", o.paths, "structure files");
  app.add_option("--sample", o.samples, "built-in structures: ubiquitin, bpti")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--spacing", p.spacings, "grid spacings, Å; 0.5,0.25 by default")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::PositiveNumber);
  app.add_option("--subdivide", p.surface.subdivisions, "midpoint subdivisions")
      ->check(CLI::Range(0, kMaxSubdivisions));
  app.add_option("--crossings", p.surface.crossings, "undo or allow")
      ->transform(names_of_values<Crossings>());
  app.add_option("--distances", p.distances, "on or off: to the exact surface as well")
      ->transform(names_of_values<Switch>());
  app.add_option("--backend", o.machine.backend, "auto, cpu or cuda")
      ->transform(names_of_values<Backend>());
  app.add_option("--devices", o.machine.devices, "CUDA devices that share an extraction")
      ->check(CLI::Range(1, 64));
}

// Standard output gets no text where it gets data.
OutputOptions place_of_data(const BenchOptions& o) {
  OutputOptions output;
  output.json = o.csv == "-" ? o.csv : o.json;
  return output;
}

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

// Warnings of the reader are printed before the table, not when they come up between its rows.
void run_pipeline(BenchOptions& o) {
  for (const std::string& path : o.paths) o.pipeline.inputs.push_back({path, "", {}, 0});
  for (const std::string& sample : o.samples) o.pipeline.inputs.push_back({"", sample, {}, 0});
  if (o.pipeline.inputs.empty()) throw InvalidInput("no INPUT: name a structure file, or --sample");
  std::ranges::sort(o.pipeline.spacings, std::greater());
  o.pipeline.machine = o.machine;
  o.pipeline.repeats = o.repeats;
  VerbSession session(o.machine);
  const PipelineBench bench = time_pipeline(o.pipeline, [&](std::size_t done, std::size_t cases) {
    if (done == 0) begin_stage(session.monitor, "pipeline", cases);
    advance(session.monitor, done == 0 ? 0 : 1);
  });
  session.end_progress();
  print_warnings(warnings_of(bench));
  if (!o.csv.empty()) write_output(o.csv, pipeline_bench_csv(bench));
  if (!o.json.empty()) write_output(o.json, pipeline_bench_json(bench));
  session.deliver_text(place_of_data(o), [&] { return pipeline_bench_text(bench); });
}

void run_thesis(BenchOptions& o) {
  if (o.thesis.tables.empty()) o.thesis.tables.assign(kThesisTables.begin(), kThesisTables.end());
  o.thesis.repeats = o.repeats;
  VerbSession session(o.machine);
  const ThesisBench bench =
      rerun_thesis(o.thesis, [&](std::size_t row, std::size_t rows, const ThesisBenchRow& next) {
        if (row == 0) begin_stage(session.monitor, "Table " + next.table, rows);
        advance(session.monitor, row == 0 ? 0 : 1);
      });
  session.end_progress();
  if (!o.csv.empty()) write_output(o.csv, thesis_bench_csv(bench));
  if (!o.json.empty()) write_output(o.json, thesis_bench_json(bench));
  session.deliver_text(place_of_data(o), [&] { return thesis_bench_text(bench); });
}

}  // namespace

Outcome run_bench(int argc, char** argv) {
  BenchOptions options;
  CLI::App app("Benchmarks of vdwmesh", "vdwmesh-bench");
  app.require_subcommand(1);
  CLI::App& thesis = *app.add_subcommand("thesis", "the tables of the thesis, rerun on its grids");
  CLI::App& pipeline = *app.add_subcommand("pipeline", "what each stage from file to file costs");
  add_thesis_options(thesis, options.thesis);
  add_pipeline_options(pipeline, options);
  add_common_options(thesis, options);
  add_common_options(pipeline, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return {app.exit(error) == 0 ? kDone : kBadInput, ""};
  }
  return outcome_of([&] {
    options.machine.memory_limit = default_memory_limit();
    thesis.parsed() ? run_thesis(options) : run_pipeline(options);
  });
}

}  // namespace vdwmesh::apps

int main(int argc, char** argv) {
  using namespace vdwmesh::apps;
  install_signal_handlers();
  keep_freed_memory();
  const Outcome outcome = run_bench(argc, argv);
  if (!outcome.message.empty())
    std::fprintf(stderr, "vdwmesh-bench: %s\n", outcome.message.c_str());
  const int signal = pending_signal();
  return signal != 0 ? kSignalBase + signal : outcome.status;
}
