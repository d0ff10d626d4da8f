// `vdwmesh pockets`: pockets, channels and voids, exactly. The balls are the atoms grown by the
// probe, so a pocket is where the centre of the probe can be.
#include "command_line/command_line.hpp"
#include "memory_plan.hpp"
#include "report/output.hpp"
#include "steps/exact_steps.hpp"
#include "steps/steps.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {

void run_pockets(const Options& options) {
  VerbSession session(options.machine);
  const InputOptions& input = options.inputs.front();
  const auto [molecule, spheres] = load(input, session);
  MemoryDemand demand;
  demand.exact = UnionMethod::cgal;
  check_memory_before(demand, spheres, options.machine.memory_limit);
  session.end_stage(&Timing::plan);
  begin_stage(session.monitor, "pockets", 1);
  const PocketTable table =
      pockets(spheres, {.monitor = session.monitor, .memory_limit = options.machine.memory_limit});
  session.report.pockets = pocket_report(table, molecule, input.probe);
  session.report.warn_if(
      table.face_ties > 0,
      "{} orthogonal centres lie exactly in a face: the pockets depend on how such ties are "
      "broken; move the atoms a little to see how much",
      table.face_ties);
  session.end_stage(&Timing::exact);
  session.end_progress();
  write_output(options.output.csv, pocket_csv(*session.report.pockets));
  session.end_stage(&Timing::write);
  session.deliver_report(options.output);
}

}  // namespace vdwmesh::apps
