// Describes the report: which keys its blocks have, in which order, and what stands under them. The
// document is that of docs/report.schema.json, which changes together with this file. Keys keep
// their names; a block that was not computed is an empty optional, which becomes null.
#include "build_id.hpp"
#include "report/describe_comparison.hpp"
#include "report/json_text.hpp"

namespace vdwmesh::apps {
namespace {

template <class Vector>
auto row_of(const Vector& v) {
  return std::vector{v.x, v.y, v.z};
}

}  // namespace

void describe(JsonText& a, const GridSpec& grid) {
  a("origin", row_of(grid.origin));
  a("cells", row_of(grid.cells));
  a("cell_count", grid.cell_count());
}

// Parameters that the mesher or the field does not have are null, whatever their defaults are.
void describe(JsonText& a, const ParametersReport& parameters) {
  const SurfaceOptions& surface = parameters.surface;
  const auto& grid = parameters.grid;
  const bool is_exact = surface.mesher == Mesher::exact;
  a("surface", surface.kind);
  a("mesher", surface.mesher);
  const std::string& reason = surface.mesher_reason;
  a("mesher_reason", reason.empty() ? std::nullopt : std::optional(reason));
  a("edge_length", is_exact ? surface.edge_length : std::nullopt);
  a("density", surface.density), a("max_distance", surface.max_distance);
  const EdgeGrading& grading = surface.grading;
  a("relative_edge", grading.relative);
  a("edge_length_of", grading.groups);
  a("edge_lengths", grading.table.empty() ? std::nullopt : std::optional(grading.table));
  a("min_angle", surface.min_angle);
  a("field", surface.field.kind), a("preset", surface.field.preset);
  a("spacing", of(grid, &GridSpec::spacing));
  a("padding",
    grid ? std::optional(surface.grid.padding.value_or(3 * grid->spacing)) : std::nullopt);
  a("isovalue", parameters.isovalue), a("blobbiness", parameters.blobbiness);
  a("subdivide", surface.subdivisions);
  // The excluded surface is refined to its patches.
  const bool to_patches = surface.kind == ExactSurface::excluded && surface.subdivisions > 0;
  a("project", to_patches ? std::string_view("patches") : name_of(surface.projection));
  a("crossings", surface.looks_for_crossings() ? std::optional(surface.crossings) : std::nullopt);
  a("grid", grid);
  a("memory_limit", limit_of(parameters.memory_limit));
  a("memory_estimate", parameters.memory_estimate);
}

void describe(JsonText& a, const ColorScale& scale) {
  a("title", scale.title), a("color_map", scale.map);
  a("lower", scale.lower), a("upper", scale.upper);
}

void describe(JsonText& a, const PictureReport& picture) {
  a("path", picture.path);
  a("width", picture.width), a("height", picture.height);
  a("view", picture.view);
  a("device", picture.device);
  a("scale", picture.scale);
  a("filled_by", Backend::cpu);  // who wrote the vertex buffers
}

void describe(JsonText& a, const Seconds& seconds) {
  for (const auto& [name, value] : seconds.stages) a(name, value);
}

void describe(JsonText& a, const Timing& timing) {
  describe(a, wall_seconds(timing));
  a("cpu", cpu_seconds(timing));
}

std::string to_json(const Report& report) {
  JsonText json;
  json("schema", "vdwmesh-report/1");
  json("version", kVersion), json("revision", kRevision);
  json("input", report.input);
  json("parameters", report.parameters);
  json("backend", report.backend);
  json("mesh", report.mesh);
  json("exact", report.exact);
  json("excluded", report.excluded);
  json("interfaces", report.interfaces);
  json("comparison", report.comparison);
  json("picture", report.picture);
  json("pockets", report.pockets);
  if (report.scan) json("scan", *report.scan);
  if (report.shell) json("shell", *report.shell);
  if (report.way) json("way", *report.way);
  json("timing", report.timing);
  json("notes", report.notes), json("warnings", report.warnings);
  return std::move(json).take();
}

}  // namespace vdwmesh::apps
