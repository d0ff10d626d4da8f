// The document that docs/report.schema.json describes.
#include "report_json.hpp"

#include "build_id.hpp"
#include "picture_options.hpp"

namespace vdwmesh::apps {
namespace {

constexpr const char* kSchema = "vdwmesh-report/1";

template <class T, class Convert>
Json block(const std::optional<T>& value, Convert convert) {
  return value ? convert(*value) : Json(nullptr);
}

Json vector_json(const auto& v) { return Json::array({v.x, v.y, v.z}); }

Json grid_json(const GridSpec& grid) {
  return {{"origin", vector_json(grid.origin)},
          {"cells", vector_json(grid.cells)},
          {"cell_count", grid.cell_count()}};
}

Json parameters_json(const ParametersReport& parameters) {
  const SurfaceOptions& surface = parameters.surface;
  const auto& grid = parameters.grid;
  return {
      {"mesher", mesher_name(surface.mesher)},
      {"edge_length", surface.mesher == Mesher::exact ? Json(surface.edge_length) : Json(nullptr)},
      {"field", field_name(surface.field.kind)},
      {"preset", preset_name(surface.field.preset)},
      {"spacing", grid ? Json(grid->spacing) : Json(nullptr)},
      {"padding", grid ? Json(surface.grid.padding.value_or(3 * grid->spacing)) : Json(nullptr)},
      {"isovalue", or_null(parameters.isovalue)},
      {"blobbiness", or_null(parameters.blobbiness)},
      {"subdivide", surface.subdivisions},
      {"project", projection_name(surface.projection)},
      {"grid", grid ? grid_json(*grid) : Json(nullptr)},
      {"memory_limit",
       parameters.memory_limit == kNoMemoryLimit ? Json(nullptr) : Json(parameters.memory_limit)},
      {"memory_estimate", or_null(parameters.memory_estimate)}};
}

Json arrangement_json(const std::optional<ExactMeshStats>& stats) {
  if (!stats) return nullptr;
  return {{"arcs", stats->arcs},
          {"corners", stats->corners},
          {"points", stats->points},
          {"contacts", stats->contacts},
          {"joins", stats->joins},
          {"euler_difference", stats->euler_difference},
          {"shell_difference", stats->shell_difference},
          {"pieces", stats->pieces},
          {"split", stats->split},
          {"seconds", stats->arrangement_seconds}};
}

Json distribution_json(const Distribution& d) {
  return {{"min", d.min}, {"p01", d.p01}, {"median", d.median},
          {"p99", d.p99}, {"max", d.max}, {"mean", d.mean}};
}

Json level_json(const ProjectionStats& level) {
  return {{"projected", level.projected},
          {"unconverged", level.unconverged},
          {"out_of_reach", level.out_of_reach},
          {"undone", level.undone},
          {"turned", level.turned},
          {"iterations_max", level.iterations_max},
          {"residual_max", level.residual_max}};
}

Json newton_json(const std::vector<ProjectionStats>& levels) {
  if (levels.empty()) return nullptr;
  const NewtonSummary sum = summarize(levels);
  Json by_level = Json::array();
  for (const ProjectionStats& level : levels) by_level.push_back(level_json(level));
  return {{"iterations_max", sum.iterations_max},
          {"residual_max", sum.residual_max},
          {"unconverged", sum.unconverged},
          {"out_of_reach", sum.out_of_reach},
          {"projected", sum.projected},
          {"undone", sum.undone},
          {"turned", sum.turned},
          {"levels", by_level}};
}

Json levels_json(const std::vector<LevelReport>& levels) {
  Json list = Json::array();
  for (const LevelReport& level : levels) {
    list.push_back({{"level", level.level},
                    {"vertices", level.vertices},
                    {"triangles", level.triangles},
                    {"area", level.measures.area},
                    {"volume", or_null(level.measures.volume)},
                    {"self_intersections", or_null(level.self_intersections)},
                    {"min_angle_deg", distribution_json(level.quality.min_angle_deg)},
                    {"aspect_ratio", distribution_json(level.quality.aspect_ratio)},
                    {"edge_length", distribution_json(level.quality.edge_length)}});
  }
  return list;
}

Json cgal_json(const std::optional<CgalMeasures>& cgal) {
  if (!cgal) return nullptr;
  return {{"closed", cgal->closed},
          {"valid", cgal->valid},
          {"shells", cgal->shells},
          {"area", cgal->area},
          {"volume", or_null(cgal->volume)}};
}

Json mesh_json(const MeshReport& mesh) {
  const MeshTopology& topology = mesh.topology;
  return {{"path", or_null(mesh.path)},
          {"vertices", topology.vertices},
          {"edges", topology.edges},
          {"triangles", topology.triangles},
          {"area", mesh.measures.area},
          {"volume", or_null(mesh.measures.volume)},
          {"outer_area", or_null(mesh.measures.outer_area)},
          {"void_area", or_null(mesh.measures.void_area)},
          {"shells", topology.shells},
          {"components", or_null(topology.components)},
          {"voids", or_null(topology.voids)},
          {"genus", or_null(topology.genus)},
          {"euler_characteristic", topology.euler_characteristic},
          {"grid_clipped", or_null(mesh.grid_clipped)},
          {"clamped_vertices", or_null(mesh.clamped_vertices)},
          {"closed", topology.closed},
          {"manifold", topology.manifold},
          {"oriented", topology.oriented},
          {"degenerate_triangles", mesh.quality.degenerate_triangles},
          {"self_intersections", or_null(mesh.self_intersections)},
          {"min_angle_deg", distribution_json(mesh.quality.min_angle_deg)},
          {"aspect_ratio", distribution_json(mesh.quality.aspect_ratio)},
          {"edge_length", distribution_json(mesh.quality.edge_length)},
          {"newton", newton_json(mesh.projection)},
          {"levels", levels_json(mesh.levels)},
          {"arrangement", arrangement_json(mesh.arrangement)},
          {"extrapolated_area", or_null(mesh.extrapolated_area)},
          {"extrapolated_volume", or_null(mesh.extrapolated_volume)},
          {"cgal", cgal_json(mesh.cgal)},
          {"notes", mesh.notes}};
}

Json shells_json(const std::vector<Shell>& shells) {
  Json list = Json::array();
  for (const Shell& shell : shells)
    list.push_back({{"area", shell.area}, {"volume", shell.volume}});
  return list;
}

Json statistics_json(const DistanceStatistics& d) {
  return {{"mean", d.mean},
          {"rms", d.rms},
          {"max", d.max},
          {"p50", d.p50},
          {"p95", d.p95},
          {"p99", d.p99},
          {"mean_error", d.mean_error},
          {"rms_error", d.rms_error},
          {"samples", d.samples}};
}

Json comparison_json(const Comparison& comparison) {
  const auto of_distances = [&](auto read) -> Json {
    return comparison.distances ? Json(read(*comparison.distances)) : Json(nullptr);
  };
  using D = MeshDistances;
  return {
      {"area_relative_error", comparison.area_relative_error},
      {"volume_relative_error", or_null(comparison.volume_relative_error)},
      {"euler_characteristic_difference", or_null(comparison.euler_characteristic_difference)},
      {"mesh_to_surface",
       of_distances([](const D& d) { return statistics_json(d.mesh_to_surface); })},
      {"surface_to_mesh",
       of_distances([](const D& d) { return statistics_json(d.surface_to_mesh); })},
      {"hausdorff_lower_bound", of_distances([](const D& d) { return d.hausdorff_lower_bound; })},
      {"samples", of_distances([](const D& d) { return d.samples; })},
      {"seed", of_distances([](const D& d) { return d.seed; })}};
}

Json scale_json(const ColorScale& scale) {
  return {{"title", scale.title},
          {"color_map", color_map_name(scale.map)},
          {"lower", scale.lower},
          {"upper", scale.upper}};
}

Json picture_json(const PictureReport& picture) {
  return {{"path", picture.path},
          {"width", picture.width},
          {"height", picture.height},
          {"view", picture.view},
          {"device", picture.device},
          {"scale", block(picture.scale, scale_json)},
          {"filled_by", backend_name(picture.filled_by)}};
}

Json timing_json(const Timing& timing) {
  return {{"read", or_null(timing.read)},
          {"field", or_null(timing.field)},
          {"extract", or_null(timing.extract)},
          {"build", or_null(timing.build)},
          {"refine", or_null(timing.refine)},
          {"exact", or_null(timing.exact)},
          {"compare", or_null(timing.compare)},
          {"picture", or_null(timing.picture)},
          {"total", timing.total}};
}

}  // namespace

Json input_json(const InputReport& input) {
  Json skipped = Json::object();
  for (const auto& [reason, count] : input.skipped) skipped[reason] = count;
  Json assumed = Json::array();
  for (const AssumedRadius& radius : input.radii_assumed) {
    assumed.push_back(
        {{"element", radius.element}, {"radius", radius.radius}, {"count", radius.count}});
  }
  Json guessed = Json::array();
  for (const GuessedElement& guess : input.unusual_elements_guessed) {
    guessed.push_back({{"element", guess.element},
                       {"residue", guess.residue_name},
                       {"atom", guess.atom_name},
                       {"count", guess.count}});
  }
  return {{"path", input.path},
          {"format", input.format},
          {"model", input.model},
          {"assembly", input.assembly},
          {"atoms_read", input.atoms_read},
          {"atoms_used", input.atoms_used},
          {"spheres", input.spheres},
          {"skipped", skipped},
          {"radius_set", input.radius_set},
          {"probe", input.probe},
          {"radii_assumed", assumed},
          {"elements_guessed", input.elements_guessed},
          {"unusual_elements_guessed", guessed}};
}

Json backend_json(const BackendReport& backend) {
  return {{"requested", backend_name(backend.requested)},
          {"used", backend_name(backend.used)},
          {"device", or_null(backend.device)},
          {"driver", or_null(backend.driver)},
          {"reason", or_null(backend.reason)},
          {"devices", backend.devices},
          {"threads", backend.threads}};
}

Json exact_json(const ExactUnion& exact) {
  const auto of_topology = [&](auto read) -> Json {
    return exact.topology ? Json(read(*exact.topology)) : Json(nullptr);
  };
  using T = UnionTopology;
  return {{"method", method_name(exact.method)},
          {"area", exact.area},
          {"outer_area", of_topology([](const T& t) { return t.outer_area; })},
          {"void_area", of_topology([](const T& t) { return t.void_area; })},
          {"volume", exact.volume},
          {"void_volume", of_topology([](const T& t) { return t.void_volume; })},
          {"shells", of_topology([](const T& t) { return t.shells.size(); })},
          {"components", of_topology([](const T& t) { return t.components; })},
          {"tunnels", of_topology([](const T& t) { return t.tunnels; })},
          {"voids", of_topology([](const T& t) { return t.voids; })},
          {"euler_characteristic", of_topology([](const T& t) { return t.euler_characteristic; })},
          {"point_contacts", of_topology([](const T& t) { return t.point_contacts; })},
          {"hidden_atoms", of_topology([](const T& t) { return t.hidden_spheres; })},
          {"shell_measures", of_topology([](const T& t) { return shells_json(t.shells); })},
          {"check_area", or_null(exact.check_area)},
          {"check_volume", or_null(exact.check_volume)},
          {"fallback_spheres", exact.fallback_spheres}};
}

std::string to_json(const Report& report) {
  return write_json({{"schema", kSchema},
                     {"version", kVersion},
                     {"revision", kRevision},
                     {"input", input_json(report.input)},
                     {"parameters", block(report.parameters, parameters_json)},
                     {"backend", block(report.backend, backend_json)},
                     {"mesh", block(report.mesh, mesh_json)},
                     {"exact", block(report.exact, exact_json)},
                     {"comparison", block(report.comparison, comparison_json)},
                     {"picture", block(report.picture, picture_json)},
                     {"timing", timing_json(report.timing)},
                     {"notes", report.notes},
                     {"warnings", report.warnings}});
}

}  // namespace vdwmesh::apps
