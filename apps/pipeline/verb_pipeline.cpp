#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "bench_output.hpp"
#include "machine.hpp"
#include "parse.hpp"
#include "pipeline/pipeline_bench.hpp"
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

class PipelineBenchVerb : public Verb {
 public:
  std::string name() const override { return "pipeline"; }
  std::string summary() const override {
    return "stage by stage from structure file to mesh file: seconds, bytes, memory, floor";
  }

  void add_options(CLI::App& app) override {
    input_.add_to(app, InputFlags::Inputs::several);
    app.add_option("--spacing", spacings_, "grid spacings, Å [" + spacings_ + "]");
    app.add_option("--subdivide", subdivisions_, "subdivisions [" + subdivisions_ + "]");
    app.add_option("--distances", distances_, "to the exact surface as well, on or off [off]");
    app.add_option("--repeat", repeat_, "runs of which the fastest counts; long ones run once [3]");
    machine_.add_to(app, MachineFlags::Backends::choose);
    output_.add_to(app);
  }

  void run() const override {
    PipelineBenchOptions options;
    NamedFiles files;
    options.inputs = input_.resolve_all(files);
    options.spacings = parse_lengths("--spacing", spacings_);
    options.subdivisions =
        static_cast<int>(parse_integer("--subdivide", subdivisions_, 0, kMaxSubdivisions));
    options.distances = switch_of_name("--distances", distances_);
    options.repeats = static_cast<int>(parse_integer("--repeat", repeat_, 1, 1000));
    options.machine = machine_.resolve();
    const BenchOutputs outputs = output_.resolve(files);
    Machine machine(options.machine);
    const PipelineBench bench =
        run_pipeline_bench(options, [&](std::size_t done, std::size_t cases) {
          if (done == 0) begin_stage(machine.monitor(), "pipeline", cases);
          advance(machine.monitor(), done == 0 ? 0 : 1);
        });
    machine.end_progress();
    print_warnings(warnings_of(bench));
    deliver(outputs,
            {[&] { return pipeline_bench_text(bench); }, [&] { return pipeline_bench_csv(bench); },
             [&] { return pipeline_bench_json(bench); }},
            options.machine.verbosity);
  }

 private:
  InputFlags input_;
  std::string spacings_ = "0.5,0.25", subdivisions_ = "0", distances_ = "off", repeat_ = "3";
  MachineFlags machine_;
  BenchOutputFlags output_;
};

}  // namespace

std::unique_ptr<Verb> make_pipeline_bench_verb() { return std::make_unique<PipelineBenchVerb>(); }

}  // namespace vdwmesh::apps
