// `vdwmesh report`: makes the mesh and the exact union and sets one beside the other. Nothing is
// written but what was asked for: JSON, the table by atom, a picture of the distances.
#include "analysis/mesh_measures.hpp"
#include "command_line/command_line.hpp"
#include "edge_lengths.hpp"
#include "measured_mesh.hpp"
#include "output.hpp"
#include "per_atom.hpp"
#include "picture.hpp"
#include "steps.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {

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
