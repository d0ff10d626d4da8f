// `vdwmesh exact`: the exact measures of the union, without a mesh. The report is that of `report`
// with the blocks of the mesh empty, so that scripts read both alike. Memory is checked for the
// union alone.
#include "command_line/command_line.hpp"
#include "memory_plan.hpp"
#include "report/output.hpp"
#include "report/per_atom.hpp"
#include "steps/exact_steps.hpp"
#include "steps/excluded_steps.hpp"
#include "steps/steps.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {
namespace {

// The exact measures of the excluded surface. The balls of which memory is checked are those grown
// by the probe.
void run_excluded(const Options& options, const Molecule& molecule, VerbSession& session) {
  const Switch per_atom =
      options.output.per_atom.empty() && options.output.atoms.empty() ? Switch::off : Switch::on;
  const double probe = options.inputs.front().probe;
  if (options.machine.backend == Backend::cuda) {
    measure_excluded_on_cuda(molecule, probe, per_atom, session);
  } else {
    const Switch gradients = options.output.gradient.empty() ? Switch::off : Switch::on;
    measure_excluded(molecule, probe, options.exact, per_atom, session, gradients);
  }
  write_excluded_atoms(options.output, molecule, session);
  write_excluded_gradient(options.output, session);
  write_depths(options.output, molecule, probe, session);
  write_atoms(options.output, molecule, probe, session);
  session.deliver_report(options.output);
}

// Makes a table and writes it if there is a name for it.
template <class Text>
void write_table(const std::string& where, const Text& text, VerbSession& session) {
  if (where.empty()) return;
  session.end_progress();
  write_output(where, text());
  session.end_stage(&Timing::write);
}

}  // namespace

void run_exact(const Options& options) {
  VerbSession session(options.machine);
  const InputOptions& input = options.inputs.front();
  const auto [molecule, spheres] = load(input, session);
  check_references(options.output, molecule, input.probe);
  MemoryDemand demand;
  demand.exact = method_for_memory(options.exact);
  check_memory_before(demand, spheres, options.machine.memory_limit);
  session.end_stage(&Timing::plan);
  if (options.exact.surface == ExactSurface::excluded) {
    run_excluded(options, molecule, session);
    return;
  }
  measure_exactly(spheres, options.exact, session, measured_spheres(molecule));
  measure_polarity(molecule, session);
  const PerAtomTable table{molecule, input.probe, *session.report.exact, {}, options.output.group};
  write_table(
      options.output.per_atom, [&] { return per_atom_csv(table); }, session);
  write_table(
      options.output.residues, [&] { return residue_areas_text(table); }, session);
  write_voids(options.output, molecule, input.probe, session);
  write_gradient(options.output, spheres, session);
  write_depths(options.output, molecule, input.probe, session);
  write_atoms(options.output, molecule, input.probe, session);
  session.deliver_report(options.output);
}

}  // namespace vdwmesh::apps
