// `vdwmesh interface`: what chains, or groups of atoms that are named, bury of each other's
// accessible surface, and where they touch. The report is that of `exact` with other blocks filled.
#include "command_line/command_line.hpp"
#include "memory_plan.hpp"
#include "report/output.hpp"
#include "report/per_atom.hpp"
#include "steps/interface_steps.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {

void run_interface(const Options& options) {
  VerbSession session(options.machine);
  const InputOptions& input = options.inputs.front();
  const Structure structure = load(input, session);
  const Sides sides = sides_of(structure.molecule, input.read.groups);
  MemoryDemand demand;
  demand.exact = UnionMethod::arcs;
  check_memory_before(demand, structure.spheres, options.machine.memory_limit);
  session.end_stage(&Timing::plan);
  const Interfaces found = measure_interfaces(structure, sides, input,
                                              {options.distances, options.exact.surface}, session);
  if (!options.output.per_atom.empty()) {
    session.end_progress();
    write_output(options.output.per_atom, interface_csv({.molecule = structure.molecule,
                                                         .probe = input.probe,
                                                         .sides = sides.names,
                                                         .side_of_atom = sides.of_atom,
                                                         .found = found,
                                                         .group = options.output.group}));
    session.end_stage(&Timing::write);
  }
  if (!options.output.atoms.empty())
    write_atom_file(options.output.atoms, structure.molecule,
                    interface_figures(found, options.output.interface_figure), session);
  session.deliver_report(options.output);
}

}  // namespace vdwmesh::apps
