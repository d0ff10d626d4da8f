// The steps of `vdwmesh report` and `interface`, and of excluded surfaces, for one structure of
// many. Each structure has a session of its own, without a progress bar. Its steps run on the
// thread of the worker, and other threads help only when they have no structure left.
#include "verbs/batch_report.hpp"

#include <limits>
#include <utility>

#include "steps/edge_lengths.hpp"
#include "steps/exact_steps.hpp"
#include "steps/excluded_steps.hpp"
#include "steps/interface_steps.hpp"
#include "steps/measured_mesh.hpp"
#include "steps/steps.hpp"

namespace vdwmesh::apps {
namespace {

Session session_of(const Options& options, const BatchOptions& one) {
  Session session{options.machine, nullptr, {}, {}};
  session.machine.backend = Backend::cpu;
  session.machine.memory_limit = one.read.memory_limit;
  return session;
}

// Reads a structure and describes it in its row and in the report.
Structure read_into(BatchRow& row, const NamedStructure& source, const InputOptions& input,
                    const BatchOptions& one, Session& session) {
  Molecule molecule = read_named_structure(source, one.read);
  describe_input(molecule, row);
  describe_input(molecule, input, session);
  SphereSet spheres = to_spheres(molecule, input.probe);
  return {std::move(molecule), std::move(spheres)};
}

// The row of a structure; with its error if `fill` refuses it.
template <class Row, class Fill>
Row row_of(const NamedStructure& structure, const Fill& fill) {
  Row row;
  row.name = structure.name;
  row.content = content_of(structure);
  row.error = refusal_of([&] { fill(row); });
  return row;
}

void report_into(ReportRow& row, const NamedStructure& source, Options options,
                 const BatchOptions& one) {
  Session session = session_of(options, one);
  options.machine = session.machine;
  const Structure structure = read_into(row, source, options.inputs.front(), one, session);
  const IndexedMesh mesh =
      make_measured_mesh(structure.spheres, with_edge_lengths(options, structure), session);
  measure_exactly(structure.spheres, options.exact, session, measured_spheres(structure.molecule));
  compare_with_exact(mesh, structure.spheres, options.distances, session);
  prove(mesh, structure.molecule, session);
  add_warnings(session.report);
  Report& report = session.report;
  describe_union(*report.exact, row);
  row.mesh = std::move(report.mesh);
  row.comparison = std::move(report.comparison);
  row.warnings = std::move(report.warnings);
  if (row.mesh->arrangement)
    row.mesh->arrangement->arrangement_seconds = std::numeric_limits<double>::quiet_NaN();
}

void interfaces_into(InterfaceRow& row, const NamedStructure& source, const Options& options,
                     const BatchOptions& one) {
  Session session = session_of(options, one);
  const InputOptions& input = options.inputs.front();
  const Structure structure = read_into(row, source, input, one, session);
  one.check(structure.spheres);
  measure_interfaces(structure, sides_of(structure.molecule, {}), input,
                     {options.distances, options.exact.surface}, session);
  row.interfaces = std::move(session.report.interfaces);
  row.warnings = std::move(session.report.warnings);
}

void excluded_into(ExcludedRow& row, const NamedStructure& source, const Options& options,
                   const BatchOptions& one) {
  Session session = session_of(options, one);
  const InputOptions& input = options.inputs.front();
  const Structure structure = read_into(row, source, input, one, session);
  one.check(structure.spheres);
  measure_excluded(structure.molecule, input.probe, options.exact, Switch::off, session);
  const ExcludedSurface& complete = session.report.excluded->complete;
  row.area = complete.area, row.volume = complete.volume;
  row.euler_characteristic = complete.euler_characteristic;
  if (complete.topology) {
    const ShellFigures figures = shell_figures(*complete.topology);
    row.components = figures.outer, row.voids = figures.walls;
    row.tunnels = static_cast<std::uint64_t>(figures.genus);
  }
  row.excluded = std::move(session.report.excluded);
  row.warnings = std::move(session.report.warnings);
}

}  // namespace

ExcludedRow make_excluded_row(const NamedStructure& structure, const Options& options,
                              const BatchOptions& one) {
  return row_of<ExcludedRow>(
      structure, [&](ExcludedRow& row) { excluded_into(row, structure, options, one); });
}

InterfaceRow make_interface_row(const NamedStructure& structure, const Options& options,
                                const BatchOptions& one) {
  auto row = row_of<InterfaceRow>(
      structure, [&](InterfaceRow& made) { interfaces_into(made, structure, options, one); });
  row.fit = options.distances.distances;
  return row;
}

ReportRow make_report_row(const NamedStructure& structure, const Options& options,
                          const BatchOptions& one) {
  return row_of<ReportRow>(structure,
                           [&](ReportRow& row) { report_into(row, structure, options, one); });
}

}  // namespace vdwmesh::apps
