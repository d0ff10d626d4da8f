// `vdwmesh view`: a page that shows a structure. Its figures are those of `exact`, `pockets` and
// `interface`. All of it is made on the CPU, so that the page does not depend on the machine.
#include <fmt/format.h>

#include <filesystem>

#include "batch/molecule_spheres.hpp"
#include "command_line/command_line.hpp"
#include "memory_plan.hpp"
#include "report/output.hpp"
#include "steps/exact_steps.hpp"
#include "steps/excluded_steps.hpp"
#include "steps/interface_steps.hpp"
#include "structure/reference_areas.hpp"
#include "verbs/verbs.hpp"
#include "view/view.hpp"

namespace vdwmesh::apps {
namespace {

void check_exact_memory(const SphereSet& spheres, const ExactOptions& exact,
                        const Session& session) {
  MemoryDemand demand;
  demand.exact = method_for_memory(exact);
  demand.page = Switch::on;
  check_memory_before(demand, spheres, session.machine.memory_limit);
}

// The exposed areas of the atoms, Å². The exact surface is in the report then.
std::vector<double> measure_surface(const Options& options, const Structure& structure,
                                    Session& session) {
  const auto& [molecule, spheres] = structure;
  check_exact_memory(spheres, options.exact, session);
  std::vector<double> areas;
  if (options.exact.surface == ExactSurface::excluded) {
    measure_excluded(molecule, options.inputs.front().probe, options.exact, Switch::on, session);
    for (const auto& [area, volume] : session.report.excluded->complete.per_atom) {
      areas.push_back(area.contact + area.saddle + area.concave);
    }
    return areas;
  }
  measure_exactly(spheres, options.exact, session);
  measure_polarity(molecule, session);
  for (const SphereMeasures& measures : session.report.exact->per_sphere) {
    areas.push_back(measures.area);
  }
  return areas;
}

void find_pockets(const Structure& grown, double probe, Session& session) {
  begin_stage(session.monitor, "pockets", 1);
  const PocketTable table = pockets(
      grown.spheres, {.monitor = session.monitor, .memory_limit = session.machine.memory_limit});
  session.report.pockets = pocket_report(table, grown.molecule, probe);
  session.report.warn_if(table.face_ties > 0, kPocketTies, table.face_ties);
  session.end_stage(&Timing::exact);
}

void find_interfaces(const Structure& grown, InputOptions input, StructureView& view,
                     Session& session) {
  const Sides& sides = view.chains;
  if (sides.names.size() < 2) return;
  input.probe = view.probe;
  const DistanceChoice no_fit{.distances = Switch::off};
  const Interfaces found =
      measure_interfaces(grown, sides, input, {no_fit, ExactSurface::vdw}, session);
  for (const Interface& pair : found.pairs) {
    std::vector<SphereId>&a = view.buried_a.emplace_back(), &b = view.buried_b.emplace_back();
    for (const InterfaceAtom& atom : pair.atoms) {
      if (atom.buried() < kLeastBurial) continue;
      (sides.of_atom[atom.sphere] == pair.a ? a : b).push_back(atom.sphere);
    }
  }
}

std::string summary_of(const Report& report, const std::string& path, const StructureView& view,
                       std::size_t bytes) {
  const std::size_t interfaces = report.interfaces ? report.interfaces->size() : 0;
  return fmt::format("{:<12} {}, {:.1f} MB: {} triangles, {} pockets and voids, {} interfaces\n",
                     "Page", path, static_cast<double>(bytes) / 1e6,
                     view.display.mesh.triangle_count(), report.pockets->pockets.size(),
                     interfaces) +
         remarks_text(report) +
         fmt::format("{:<12} total {:.3f}\n", "Time (s)", report.timing.total.wall);
}

}  // namespace

void run_view(const Options& options) {
  VerbSession session(options.machine);
  session.machine.backend = Backend::cpu;
  const InputOptions& input = options.inputs.front();
  Structure structure = load(input, session);
  StructureView view{.molecule = structure.molecule,
                     .report = session.report,
                     .probe = input.probe > 0 ? input.probe : kReferenceProbe,
                     .areas = measure_surface(options, structure, session),
                     .chains = chains_of(structure.molecule),
                     .buried_a = {},
                     .buried_b = {},
                     .display = {}};
  view.display = make_display_mesh(structure, input.probe, options.surface,
                                   options.view.most_triangles, session);
  structure.spheres = to_spheres(structure.molecule, view.probe);
  check_exact_memory(structure.spheres, options.exact, session);
  find_pockets(structure, view.probe, session);
  find_interfaces(structure, input, view, session);
  // A page is passed on, and nobody is to read there in whose folder the file was.
  session.report.input.path = std::filesystem::path(session.report.input.path).filename().string();
  const std::string page = view_html(view);
  session.end_progress();
  write_file(options.view.path, page);
  session.end_stage(&Timing::write);
  session.stop_watch();
  session.deliver_text(options.output, [&] {
    return summary_of(session.report, options.view.path, view, page.size());
  });
}

}  // namespace vdwmesh::apps
