// Measures and meshes the excluded surface on the library of src/excluded, and writes what was
// found into the report of the session.
#include "excluded_steps.hpp"

#include <utility>

#include "excluded/excluded_measures.hpp"
#include "excluded/excluded_mesher.hpp"

namespace vdwmesh::apps {

void measure_excluded(const Molecule& molecule, double probe, const ExactOptions& options,
                      Switch per_atom, Session& session) {
  ExcludedOptions wanted{.probe = probe, .monitor = session.monitor};
  wanted.per_atom = per_atom == Switch::on;
  wanted.shells = options.topology == TopologyRequest::full;
  wanted.exterior = true;
  session.report.excluded = excluded_measures(to_spheres(molecule, 0), wanted);
  const std::uint64_t doubtful = session.report.excluded->complete.checks.uncertified_patches;
  session.report.warn_if(
      doubtful > 0,
      "{} concave patches of the excluded surface are not certified: area, volume "
      "and topology may be wrong there",
      doubtful);
  session.end_stage(&Timing::exact);
}

IndexedMesh make_excluded_mesh(const Molecule& molecule, double probe,
                               const SurfaceOptions& surface, Session& session) {
  Report& report = session.report;
  report.backend = describe_backend(session.machine.backend, Backend::cpu);
  ExcludedMeshOptions options;
  options.probe = probe;
  options.edge_length = surface.edge_length.value_or(options.edge_length);
  options.memory_limit = session.machine.memory_limit;
  options.monitor = session.monitor;
  ParametersReport& parameters = report.parameters.emplace();
  parameters.surface = surface;
  parameters.memory_limit = options.memory_limit;
  ExcludedMesh made = mesh_excluded(to_spheres(molecule, 0), options);
  report.timing.extract = made.stats.seconds;
  session.end_stage(&Timing::mesh);
  return std::move(made.mesh);
}

}  // namespace vdwmesh::apps
