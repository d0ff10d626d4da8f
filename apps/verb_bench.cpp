#include <fmt/format.h>

#include <algorithm>

#include "machine.hpp"
#include "output.hpp"
#include "parse.hpp"
#include "thesis/thesis_bench.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

class BenchVerb : public Verb {
 public:
  std::string name() const override { return "bench"; }
  std::string summary() const override { return "the timing tables: bench thesis"; }

  void add_options(CLI::App& app) override {
    app.add_option("WHAT", what_, "thesis: Tables 4.1 to 4.5 of the thesis, rerun on its grids");
    app.add_option("--structures", structures_, "folder of the thesis's structure files");
    app.add_option("--table", tables_, "of 4.1 4.2 4.3 4.4 4.5 [all]")
        ->delimiter(',')
        ->allow_extra_args(false);
    app.add_option("--entry", entries_, "PDB ids of the thesis's tables [all]")
        ->delimiter(',')
        ->allow_extra_args(false);
    app.add_option("--repeat", repeat_, "runs of which the fastest counts; long ones run once [3]");
    app.add_option("--csv", csv_, "CSV file (- is standard output)");
    machine_.add_to(app, MachineFlags::Backends::none);
    output_.add_to(app, OutputFlags::PerAtom::none);
  }

  void run() const override {
    const ThesisBenchOptions options = resolve();
    const MachineOptions machine_options = machine_.resolve();
    const OutputOptions output = output_.resolve();
    if (!csv_.empty() && csv_ != "-") check_writable("--csv", csv_);
    Machine machine(machine_options);
    Monitor* monitor = machine.monitor();
    const ThesisBench bench = run_thesis_bench(
        options, [&](std::size_t row, std::size_t rows, const ThesisBenchRow& next) {
          if (row == 0) begin_stage(monitor, "Table " + next.table, rows);
          advance(monitor, row == 0 ? 0 : 1);
        });
    machine.end_progress();
    deliver_tables(bench, output.json, machine_options.verbosity);
  }

 private:
  ThesisBenchOptions resolve() const {
    if (what_ != "thesis") {
      throw InvalidInput(fmt::format("bench {}: this version has only bench thesis", what_));
    }
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

  void deliver_tables(const ThesisBench& bench, const std::string& json,
                      Verbosity verbosity) const {
    if (csv_ == "-") write_standard_output(thesis_bench_csv(bench));
    if (json == "-") write_standard_output(thesis_bench_json(bench));
    if (!csv_.empty() && csv_ != "-") write_file(csv_, thesis_bench_csv(bench));
    if (!json.empty() && json != "-") write_file(json, thesis_bench_json(bench));
    const bool taken = csv_ == "-" || json == "-" || verbosity == Verbosity::quiet;
    if (!taken) write_standard_output(thesis_bench_text(bench));
  }

  std::string what_, structures_, repeat_ = "3", csv_;
  std::vector<std::string> tables_, entries_;
  MachineFlags machine_;
  OutputFlags output_;
};

}  // namespace

std::unique_ptr<Verb> make_bench_verb() { return std::make_unique<BenchVerb>(); }

}  // namespace vdwmesh::apps
