// make_measured_mesh(): a plan of the memory, the mesh, a second plan, then one measure after the
// other. Levels of a refinement are measured as they come, because the refinement keeps none.
#include "measured_mesh.hpp"

#include <utility>
#include <vector>

#include "steps.hpp"

namespace vdwmesh::apps {

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
  if (mesh.triangle_labels() != TriangleLabels::none) extrapolate(report);
  check_with_cgal(mesh, options.cgal_check, session);
  return mesh;
}

}  // namespace vdwmesh::apps
