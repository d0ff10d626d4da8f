// `vdwmesh report`: makes the mesh and the exact union and sets one beside the other. Memory is
// checked before the mesh is made, from an estimate, and again when its size is known. Nothing is
// written but what was asked for: JSON, the table by atom, a picture of the distances.
#include <utility>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "command_line/command_line.hpp"
#include "edge_lengths.hpp"
#include "memory_plan.hpp"
#include "output.hpp"
#include "per_atom.hpp"
#include "picture.hpp"
#include "steps.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

// Normals are made only where a picture needs them.
MemoryDemand memory_of_report(const Options& options) {
  MemoryDemand demand;
  demand.surface = options.surface;
  demand.backend = resolve(options.machine.backend);
  demand.normals = options.picture.path.empty() ? Normals::none : Normals::gradients;
  demand.self_intersections = options.self_intersections;
  demand.cgal_check = options.cgal_check;
  demand.exact = method_for_memory(options.exact);
  demand.distances = options.distances.distances;
  return demand;
}

// The mesh, and what the report says of it.
IndexedMesh make_measured_mesh(const SphereSet& spheres, const Options& options, Session& session) {
  MemoryDemand demand = memory_of_report(options);
  const std::uint64_t limit = options.machine.memory_limit;
  const auto estimate = check_memory_before(demand, spheres, limit);
  session.end_stage(&Timing::plan);
  std::vector<LevelReport> levels;
  IndexedMesh mesh =
      make_mesh(spheres, options.surface, session,
                {.normals = demand.normals,
                 .on_level = record_levels(options.self_intersections, options.surface.subdivisions,
                                           levels, session)});
  session.report.parameters->memory_estimate = estimate;
  check_memory_after(demand, spheres, mesh, limit);
  MeshReport& report = *session.report.mesh;
  measure(mesh, options.self_intersections, session);
  add_last_level(options.surface.subdivisions, std::move(levels), report);
  extrapolate(mesh.triangle_labels(), report);
  check_with_cgal(mesh, options.cgal_check, session);
  return mesh;
}

}  // namespace

void run_report(const Options& options) {
  VerbSession session(options.machine);
  const InputOptions& input = options.inputs.front();
  const Structure structure = load(input, session);
  const auto& [molecule, spheres] = structure;
  const IndexedMesh mesh =
      make_measured_mesh(spheres, with_edge_lengths(options, structure), session);
  measure_exactly(spheres, options.exact, session, measured_spheres(molecule));
  measure_polarity(molecule, session);
  compare_with_exact(mesh, spheres, options.distances, session);
  prove(mesh, molecule, session);
  if (!options.picture.path.empty()) draw_distances(mesh, spheres, options.picture, session);
  if (!options.output.per_atom.empty()) {
    session.end_progress();
    write_output(options.output.per_atom,
                 per_atom_csv({molecule, input.probe, *session.report.exact,
                               mesh_area_by_sphere(mesh, spheres.size()), options.output.group}));
    session.end_stage(&Timing::write);
  }
  write_voids(options.output, molecule, session);
  session.deliver_report(options.output);
}

}  // namespace vdwmesh::apps
