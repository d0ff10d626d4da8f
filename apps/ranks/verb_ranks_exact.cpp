// The verb exact of vdwmesh-mpi: the exact measures of the union, of which every rank measures a
// share. The report, its JSON and the tables are those of the plain program.
#include "distributed/together/gradients_together.hpp"
#include "distributed/together/union_together.hpp"
#include "ranks/rank_verbs.hpp"
#include "ranks/shared_structure.hpp"
#include "report/output.hpp"
#include "report/per_atom.hpp"
#include "steps/exact_steps.hpp"
#include "steps/steps.hpp"

namespace vdwmesh::apps {
namespace {

// The spheres that --measure chose, on all ranks. Collective.
std::optional<std::vector<SphereId>> share_measured(const Ranks& ranks, const Molecule& molecule) {
  const auto chosen = measured_spheres(molecule);
  std::vector<SphereId> ids = chosen.value_or(std::vector<SphereId>());
  const bool are_chosen = ranks.sum(std::uint64_t{chosen.has_value()}) > 0;
  ranks.share(ids);
  return are_chosen ? std::optional(std::move(ids)) : std::nullopt;
}

// Shares of atoms are wanted of a table, and where the area is divided by polarity.
bool wants_atoms(const Ranks& ranks, const Options& options, const Molecule& molecule) {
  return !options.output.per_atom.empty() || ranks.sum(std::uint64_t{molecule.has_polarity}) > 0;
}

// On the first rank.
void deliver(const Options& options, const Molecule& molecule, const GradientsTogether& slopes,
             VerbSession& session) {
  const OutputOptions& output = options.output;
  measure_polarity(molecule, session);
  if (!output.per_atom.empty()) {
    session.end_progress();
    const double probe = options.inputs.front().probe;
    write_output(output.per_atom,
                 per_atom_csv({molecule, probe, *session.report.exact, {}, output.group}));
    session.end_stage(&Timing::write);
  }
  if (!output.gradient.empty())
    write_gradient(output, slopes.gradients, slopes.kink_spheres, session);
  session.deliver_report(output);
}

}  // namespace

void run_ranks_exact(const Ranks& ranks, const Options& options) {
  VerbSession session(machine_of_rank(ranks, options.machine));
  const InputOptions& input = options.inputs.front();
  const bool names_atoms = !options.output.per_atom.empty() || !input.read.measure.empty();
  const SharedStructure shared = load_together(
      ranks, input, names_atoms ? AtomRecords::needed : AtomRecords::needless, session);
  const auto measured = share_measured(ranks, shared.molecule);
  session.end_stage(&Timing::plan);
  UnionTogetherOptions wanted;
  wanted.topology = options.exact.topology;
  if (measured) wanted.measured = *measured;
  if (wants_atoms(ranks, options, shared.molecule)) wanted.per_sphere = PerSphere::keep;
  wanted.memory_limit = session.machine.memory_limit;
  wanted.monitor = session.monitor;
  ranks.together([&] {
    if (wants_device(shared.spheres, options.exact, session, measured)) {
      wanted.backend = session.machine.backend;
    }
  });
  UnionTogether together = union_together(ranks, shared.spheres, wanted);
  session.report.exact.emplace();
  session.report.exact->backend = together.backend;
  if (!together.fallback.empty()) session.report.notes.push_back(std::move(together.fallback));
  static_cast<ExactUnion&>(*session.report.exact) = std::move(together);
  GradientsTogether slopes;
  if (!options.output.gradient.empty()) {
    slopes =
        gradients_together(ranks, shared.spheres, session.machine.memory_limit, session.monitor);
  }
  session.end_stage(&Timing::exact);
  ranks.together([&] {
    if (ranks.is_first()) deliver(options, shared.molecule, slopes, session);
  });
}

}  // namespace vdwmesh::apps
