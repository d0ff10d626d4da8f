// `vdwmesh pockets`: pockets, channels and voids, exactly. The balls are the atoms grown by the
// probe, so a pocket is where the centre of the probe can be. --scan, --shell and --from ask other
// questions of the same room, in place of the table.
#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "batch/molecule_spheres.hpp"
#include "command_line/command_line.hpp"
#include "command_line/parse.hpp"
#include "excluded/two_probe_shell.hpp"
#include "memory_plan.hpp"
#include "mesh/mesh_io.hpp"
#include "pockets/pocket_meshes.hpp"
#include "report/atom_names.hpp"
#include "report/output.hpp"
#include "report/pockets/pocket_parts.hpp"
#include "report/pockets/pocket_spheres.hpp"
#include "report/pockets/scan_plot.hpp"
#include "request/refuse.hpp"
#include "steps/exact_steps.hpp"
#include "steps/steps.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {
namespace {

void mesh_pockets(const Options& options, const PocketTable& table, const SphereSet& spheres,
                  VerbSession& session) {
  PocketMeshOptions of_meshes{.monitor = session.monitor,
                              .memory_limit = options.machine.memory_limit};
  of_meshes.edge_length = options.pocket_query.edge_length.value_or(of_meshes.edge_length);
  auto meshes = pocket_meshes(spheres, table.pockets, of_meshes);
  for (std::size_t p = 0; p < meshes.size(); ++p) {
    session.report.warn_if(meshes[p].mesh.triangles.empty(),
                           "pocket {}: its mesh does not close at these edges and was left out; "
                           "try a shorter --edge-length",
                           p + 1);
  }
  const auto warnings = write_meshes(named_meshes(std::move(meshes)), options.output.pocket_meshes);
  for (const std::string& w : warnings) session.report.warn_if(true, "{}", w);
}

std::string run_table(const Options& options, const Molecule& molecule, const SphereSet& spheres,
                      VerbSession& session) {
  const PocketTable table = pockets(spheres, {.measures = options.pocket_measures,
                                              .monitor = session.monitor,
                                              .memory_limit = options.machine.memory_limit});
  session.report.pockets =
      pocket_report(table, molecule, options.inputs.front().probe, options.pocket_measures);
  session.report.warn_if(table.face_ties > 0, kPocketTies, table.face_ties);
  if (!options.output.pocket_meshes.empty()) mesh_pockets(options, table, spheres, session);
  return pocket_csv(*session.report.pockets);
}

std::string run_scan(const Options& options, const Molecule& molecule, VerbSession& session) {
  const auto [lowest, highest] = *options.pocket_query.scan;
  const ProbeScan scan = probe_scan(to_spheres(molecule, 0), lowest, highest, session.monitor,
                                    options.machine.memory_limit);
  session.report.scan = scan_report(scan, lowest, highest, molecule);
  session.report.warn_if(!scan.is_complete,
                         "places do not explain the number of voids at every radius: atoms lie as "
                         "in a crystal; move them a little to see how much");
  return scan_csv(*session.report.scan);
}

std::string run_shell(const Options& options, const Molecule& molecule, VerbSession& session) {
  const SphereSet atoms = to_spheres(molecule, 0);
  const double small = options.inputs.front().probe, large = *options.pocket_query.shell;
  refuse_if(large <= small, "--shell {}: is the larger probe; --probe has {} Å", large, small);
  const TwoProbeShell shell = two_probe_shell(atoms, small, large, session.monitor);
  session.report.shell = shell_report(shell, molecule);
  session.report.warn_if(!shell.doubt.empty(), "the shell is not divided into pockets: {}",
                         shell.doubt);
  return shell_csv(*session.report.shell);
}

// "A/57/NE2" of "A/HIS 57/NE2", as tables name atoms.
std::string plain_name(std::string name) {
  const std::size_t slash = name.find('/'), blank = name.find(' ');
  if (slash < blank && blank != name.npos) name.erase(slash + 1, blank - slash);
  return name;
}

// X,Y,Z; pocket:N, a row of the table; or an atom.
Vec3d start_of(const Options& options, const Molecule& molecule, const SphereSet& atoms,
               VerbSession& session) {
  const std::string& from = options.pocket_query.from;
  if (std::ranges::count(from, ',') == 2) {
    std::istringstream parts(from);
    std::array<double, 3> x{};
    for (double& value : x) {
      std::string part;
      std::getline(parts, part, ',');
      value = parse_number("--from", part, Range::finite, "1.5");
    }
    return {x[0], x[1], x[2]};
  }
  constexpr std::string_view kPocket = "pocket:";
  if (from.starts_with(kPocket)) {
    const auto found =
        pockets(to_spheres(molecule, options.inputs.front().probe),
                {.monitor = session.monitor, .memory_limit = options.machine.memory_limit})
            .pockets;
    refuse_if(found.empty(), "--from {}: there are no pockets", from);
    const auto rank = parse_integer("--from pocket", from.substr(kPocket.size()), 1,
                                    static_cast<std::int64_t>(found.size()));
    return found[static_cast<std::size_t>(rank - 1)].clear_place;
  }
  const std::string wanted = plain_name(from);
  for (std::size_t i = 0; i < molecule.atoms.size(); ++i) {
    const auto id = static_cast<SphereId>(i);
    if (name_of_atom(molecule, id) == wanted) return place_beside(atoms, id);
  }
  refuse("--from {}: no atom has that name; write \"A/HIS 57/NE2\", X,Y,Z or pocket:1", from);
}

std::string run_way(const Options& options, const Molecule& molecule, VerbSession& session) {
  const SphereSet atoms = to_spheres(molecule, 0);
  const Vec3d from = start_of(options, molecule, atoms, session);
  const WayOut way =
      way_out(atoms, from, kOutsideProbe, session.monitor, options.machine.memory_limit);
  session.report.way = way_report(way, options.pocket_query.from, molecule);
  return way_csv(*session.report.way);
}

// Spheres, or a plot, of what was asked for.
void write_for_viewers(const std::string& path, const Report& report) {
  if (is_plot(path)) write_file(path, report.scan ? plot_of(*report.scan) : plot_of(*report.way));
  const auto format = find_sphere_format(path);
  if (!format) return;
  const auto groups = report.scan  ? spheres_of(*report.scan)
                      : report.way ? spheres_of(*report.way)
                                   : spheres_of(*report.pockets);
  const char* all = report.scan ? "places" : report.way ? "ways" : "pockets";
  write_file(path, sphere_file(groups, all, *format));
}

}  // namespace

void run_pockets(const Options& options) {
  VerbSession session(options.machine);
  const auto [molecule, spheres] = load(options.inputs.front(), session);
  MemoryDemand demand;
  demand.exact = UnionMethod::cgal;
  check_memory_before(demand, spheres, options.machine.memory_limit);
  session.end_stage(&Timing::plan);
  begin_stage(session.monitor, "pockets", 1);
  const PocketQuery& query = options.pocket_query;
  const std::string table = query.scan            ? run_scan(options, molecule, session)
                            : query.shell         ? run_shell(options, molecule, session)
                            : !query.from.empty() ? run_way(options, molecule, session)
                                                  : run_table(options, molecule, spheres, session);
  session.end_stage(&Timing::exact);
  session.end_progress();
  write_output(options.output.csv, table);
  write_for_viewers(options.output.spheres, session.report);
  session.end_stage(&Timing::write);
  session.deliver_report(options.output);
}

}  // namespace vdwmesh::apps
