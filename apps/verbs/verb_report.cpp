// `vdwmesh report`: makes the mesh and the exact surface and sets one beside the other. Nothing is
// written but what was asked for: JSON, the table by atom, a picture of the distances.
#include <future>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "command_line/command_line.hpp"
#include "memory_plan.hpp"
#include "report/output.hpp"
#include "report/per_atom.hpp"
#include "steps/edge_lengths.hpp"
#include "steps/exact_steps.hpp"
#include "steps/excluded_steps.hpp"
#include "steps/measured_mesh.hpp"
#include "steps/picture.hpp"
#include "steps/steps.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {
namespace {

// Makes the mesh of the excluded surface and compares it. The exact measures come first, because
// they say how large the mesh will be.
void report_excluded(const Options& options, const Structure& structure, VerbSession& session) {
  const auto& [molecule, grown] = structure;
  const double probe = options.inputs.front().probe;
  const SphereSet atoms = to_spheres(molecule, 0);
  const Switch per_atom = options.output.per_atom.empty() ? Switch::off : Switch::on;
  MemoryDemand demand = memory_of_report(options);
  const std::uint64_t estimate =
      plan_excluded_mesh(structure, probe, options.exact, per_atom, demand, session);
  std::vector<LevelReport> levels;
  const PatchedMesh made = make_excluded_mesh(
      molecule, probe, options.surface, session,
      record_levels(options.self_intersections, options.surface.subdivisions, levels, session));
  const IndexedMesh& mesh = made.mesh;
  session.report.parameters->memory_estimate = estimate;
  check_memory_after(demand, grown, mesh, options.machine.memory_limit);
  measure(mesh, options.self_intersections, session);
  MeshReport& report = *session.report.mesh;
  report.patches = count_patches(made);
  add_last_level(options.surface.subdivisions, std::move(levels), report);
  extrapolate(report);
  check_with_cgal(mesh, options.cgal_check, session);
  compare_with_excluded(mesh, atoms, options.distances, session);
  prove_excluded(session);
  if (!options.picture.path.empty()) draw_distances(mesh, atoms, options.picture, session);
  write_excluded_atoms(options.output, molecule, session);
  session.deliver_report(options.output);
}

// What goes on beside the mesh: the exact union, which needs no mesh, if the CPU measures it, and
// the distances, which need only the mesh. Both are in the report or in `distances` afterwards if
// they were begun.
Companions companions_of(const SphereSet& spheres, const Options& options,
                         const MeasuredSpheres& measured, std::optional<TakenDistances>& distances,
                         Session& session) {
  Companions companions;
  if (needs_cpu(options.exact, measured)) {
    companions.while_made = {&Timing::exact,
                             [&] { measure_on_cpu(spheres, options.exact, session, measured); }};
  }
  if (options.distances.distances == Switch::on) {
    companions.while_measured = [&](const IndexedMesh& mesh) {
      return StageWork{&Timing::compare, [&] {
                         distances = take_distances(mesh, spheres, options.distances, session);
                       }};
    };
  }
  return companions;
}

}  // namespace

void run_report(const Options& options) {
  VerbSession session(options.machine);
  const std::future<void> started = start_device(options.machine, options.surface);
  const InputOptions& input = options.inputs.front();
  const Structure structure = load(input, session);
  if (options.surface.kind == ExactSurface::excluded) {
    report_excluded(options, structure, session);
    return;
  }
  const auto& [molecule, spheres] = structure;
  const MeasuredSpheres measured = measured_spheres(molecule);
  std::optional<TakenDistances> distances;
  const IndexedMesh mesh =
      make_measured_mesh(spheres, with_edge_lengths(options, structure), session,
                         companions_of(spheres, options, measured, distances, session));
  if (!session.report.exact) measure_exactly(spheres, options.exact, session, measured);
  measure_polarity(molecule, session);
  if (!distances && options.distances.distances == Switch::on)
    distances = take_distances(mesh, spheres, options.distances, session);
  compare_with_exact(spheres, distances, session);
  prove(mesh, molecule, session);
  if (!options.picture.path.empty()) draw_distances(mesh, spheres, options.picture, session);
  if (!options.output.per_atom.empty()) {
    session.end_progress();
    write_output(options.output.per_atom,
                 per_atom_csv({molecule, input.probe, *session.report.exact,
                               mesh_area_by_sphere(mesh, spheres.size()), options.output.group}));
    session.end_stage(&Timing::write);
  }
  write_voids(options.output, molecule, input.probe, session);
  session.deliver_report(options.output);
}

}  // namespace vdwmesh::apps
