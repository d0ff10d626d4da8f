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

namespace {

// Frees what a refinement has made and neither measures nor comparison read: a quarter of a refined
// mesh, whose memory the measures then take instead of new pages. The half-edges serve the
// conversion to OpenMesh for CGAL, the normals a picture.
void free_unread(IndexedMesh& mesh, const Options& options) {
  if (!checks_with_cgal(options.cgal_check, mesh.triangle_count())) {
    mesh.opposite = Buffer<std::uint32_t>();
  }
  if (options.picture.path.empty()) mesh.normals = Buffer<Vec3f>();
}

}  // namespace

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
  free_unread(mesh, options);
  MeshReport& report = *session.report.mesh;
  measure(mesh, options.self_intersections, session);
  add_last_level(options.surface.subdivisions, std::move(levels), report);
  if (mesh.triangle_labels() != TriangleLabels::none) extrapolate(report);
  check_with_cgal(mesh, options.cgal_check, session);
  return mesh;
}

}  // namespace vdwmesh::apps
