#include <CLI/CLI.hpp>
#include <algorithm>

#include "bench_output.hpp"
#include "machine.hpp"
#include "parse.hpp"
#include "thesis/thesis_bench.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

class ThesisBenchVerb : public Verb {
 public:
  std::string name() const override { return "thesis"; }
  std::string summary() const override {
    return "Tables 4.1 to 4.5 of the thesis, rerun on its grids";
  }

  void add_options(CLI::App& app) override {
    app.add_option("--structures", structures_, "folder of the thesis's structure files");
    app.add_option("--table", tables_, "of 4.1 4.2 4.3 4.4 4.5 [all]")
        ->delimiter(',')
        ->allow_extra_args(false);
    app.add_option("--entry", entries_, "PDB ids of the thesis's tables [all]")
        ->delimiter(',')
        ->allow_extra_args(false);
    app.add_option("--repeat", repeat_, "runs of which the fastest counts; long ones run once [3]");
    machine_.add_to(app, MachineFlags::Backends::none);
    output_.add_to(app);
  }

  void run() const override {
    const ThesisBenchOptions options = resolve();
    const MachineOptions machine_options = machine_.resolve();
    NamedFiles files;
    const BenchOutputs outputs = output_.resolve(files);
    Machine machine(machine_options);
    Monitor* monitor = machine.monitor();
    const ThesisBench bench = run_thesis_bench(
        options, [&](std::size_t row, std::size_t rows, const ThesisBenchRow& next) {
          if (row == 0) begin_stage(monitor, "Table " + next.table, rows);
          advance(monitor, row == 0 ? 0 : 1);
        });
    machine.end_progress();
    deliver(outputs,
            {[&] { return thesis_bench_text(bench); }, [&] { return thesis_bench_csv(bench); },
             [&] { return thesis_bench_json(bench); }},
            machine_options.verbosity);
  }

 private:
  ThesisBenchOptions resolve() const {
    if (structures_.empty()) {
      throw InvalidInput("--structures: name the folder of the structure files (110D.pdb, ...)");
    }
    ThesisBenchOptions options;
    options.structures = structures_;
    options.tables = tables_;
    for (const std::string& table : tables_) {
      if (std::ranges::count(kThesisTables, table) == 0) {
        throw_unknown_name("--table", table, kThesisTables);
      }
    }
    if (tables_.empty()) options.tables.assign(kThesisTables.begin(), kThesisTables.end());
    options.entries = entries_;
    options.repeats = static_cast<int>(parse_integer("--repeat", repeat_, 1, 1000));
    return options;
  }

  std::string structures_, repeat_ = "3";
  std::vector<std::string> tables_, entries_;
  MachineFlags machine_;
  BenchOutputFlags output_;
};

}  // namespace

std::unique_ptr<Verb> make_thesis_bench_verb() { return std::make_unique<ThesisBenchVerb>(); }

}  // namespace vdwmesh::apps
