#include <CLI/CLI.hpp>

#include "machine.hpp"
#include "memory_plan.hpp"
#include "output.hpp"
#include "per_atom.hpp"
#include "stopwatch.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

class ExactVerb : public Verb {
 public:
  std::string name() const override { return "exact"; }
  std::string summary() const override { return "exact sphere union only, no mesh"; }

  void add_options(CLI::App& app) override {
    input_.add_to(app);
    exact_.add_to(app);
    machine_.add_to(app, MachineFlags::Backends::none);
    output_.add_to(app, OutputFlags::PerAtom::offered);
  }

  void run() const override {
    const Stopwatch watch;
    NamedFiles files;
    const InputOptions input = input_.resolve(files);
    const ExactOptions exact = exact_.resolve();
    const MachineOptions machine_options = machine_.resolve();
    const OutputOptions output = output_.resolve(files);

    Machine machine(machine_options);
    Report report;
    const Molecule molecule = load(input, machine_options.memory_limit, report);
    const SphereSet spheres = to_spheres(molecule, input.probe);
    MemoryDemand demand;
    demand.exact = exact.method;
    check_memory_before(demand, spheres, machine_options.memory_limit);
    measure_exactly(spheres, exact, machine.monitor(), report);
    machine.end_progress();
    if (!output.per_atom.empty()) {
      write_output(output.per_atom,
                   per_atom_csv(molecule, input.probe, *report.exact, {}, output.group));
    }
    report.timing.total = watch.seconds();
    deliver(report, output, machine_options.verbosity);
  }

 private:
  InputFlags input_;
  ExactFlags exact_;
  MachineFlags machine_;
  OutputFlags output_;
};

}  // namespace

std::unique_ptr<Verb> make_exact_verb() { return std::make_unique<ExactVerb>(); }

}  // namespace vdwmesh::apps
