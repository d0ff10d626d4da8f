// make_measured_mesh(): a plan of the memory, the mesh, a second plan, then one measure after the
// other. Levels of a refinement are measured as they come, because the refinement keeps none. Where
// a device makes the mesh, other work of the caller goes on beside these steps.
#include "steps/measured_mesh.hpp"

#include <utility>
#include <vector>

#include "steps/steps.hpp"

namespace vdwmesh::apps {

MemoryDemand memory_of_report(const Options& options) {
  MemoryDemand demand;
  demand.surface = options.surface;
  demand.backend = resolve(options.machine.backend);
  demand.normals = options.picture.path.empty() ? Normals::none : Normals::gradients;
  demand.half_edges_up_to = most_checked_with_cgal(options.cgal_check);
  demand.self_intersections = options.self_intersections;
  demand.cgal_check = options.cgal_check;
  demand.exact = method_for_memory(options.exact);
  demand.distances = options.distances.distances;
  return demand;
}

namespace {

// Frees what the mesher has made and neither measures nor comparison read, so that the measures
// take this memory instead of new pages. The half-edges serve the conversion to OpenMesh for CGAL,
// the normals a picture. A refinement does not even make them (WantedMesh).
void free_unread(IndexedMesh& mesh, const Options& options) {
  if (!checks_with_cgal(options.cgal_check, mesh.triangle_count())) {
    mesh.opposite = Buffer<std::uint32_t>();
  }
  if (options.picture.path.empty()) mesh.normals = Buffer<Vec3f>();
}

// The levels of a refinement are measured on all cores while the mesh is made, and in a time of
// their own (record_levels()); then nothing else is done meanwhile.
IndexedMesh make_beside(const SphereSet& spheres, const SurfaceOptions& surface, Session& session,
                        const WantedMesh& request, const std::optional<StageWork>& beside) {
  if (!beside || surface.subdivisions > 0) return make_mesh(spheres, surface, session, request);
  IndexedMesh mesh;
  const auto make = [&] { mesh = make_mesh_untimed(spheres, surface, session, request); };
  run_beside(session, {{&Timing::mesh, make}}, *beside);
  return mesh;
}

void measure_beside(const IndexedMesh& mesh, SelfIntersections wanted, Session& session,
                    const StageWork& beside) {
  std::vector<StageWork> here{{&Timing::measure, [&] { examine_untimed(mesh, session); }}};
  if (wanted == SelfIntersections::count) {
    here.push_back(
        {&Timing::self_intersections, [&] { self_intersections_untimed(mesh, session); }});
  }
  run_beside(session, here, beside);
}

}  // namespace

IndexedMesh make_measured_mesh(const SphereSet& spheres, const Options& options, Session& session,
                               const Companions& companions) {
  MemoryDemand demand = memory_of_report(options);
  const bool by_device =
      demand.backend == Backend::cuda && options.surface.mesher == Mesher::marching_cubes;
  const bool any = companions.while_made || companions.while_measured;
  demand.beside = by_device && any ? Switch::on : Switch::off;
  const std::uint64_t limit = options.machine.memory_limit;
  const auto estimate = check_memory_before(demand, spheres, limit);
  session.end_stage(&Timing::plan);
  std::vector<LevelReport> levels;
  const WantedMesh request{
      .normals = demand.normals,
      .half_edges_up_to = demand.half_edges_up_to,
      .on_level =
          record_levels(options.self_intersections, options.surface.subdivisions, levels, session)};
  const bool beside = demand.beside == Switch::on;
  IndexedMesh mesh = make_beside(spheres, options.surface, session, request,
                                 beside ? companions.while_made : std::nullopt);
  session.report.parameters->memory_estimate = estimate;
  check_memory_after(demand, spheres, mesh, limit);
  free_unread(mesh, options);
  MeshReport& report = *session.report.mesh;
  if (demand.beside == Switch::on && companions.while_measured) {
    measure_beside(mesh, options.self_intersections, session, companions.while_measured(mesh));
  } else {
    measure(mesh, options.self_intersections, session);
  }
  add_last_level(options.surface.subdivisions, std::move(levels), report);
  if (mesh.triangle_labels() != TriangleLabels::none) extrapolate(report);
  check_with_cgal(mesh, options.cgal_check, session);
  return mesh;
}

}  // namespace vdwmesh::apps
