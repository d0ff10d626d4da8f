// The rules of meshes: which mesher an option asks for, and which options it has no use for. Each
// function settles one part of the options. They look at the whole request, so that the order in
// which things were said does not matter.
#include "request/mesh_request.hpp"

#include <utility>

#include "creases/exact_mesher.hpp"
#include "remesh/surface_remesher.hpp"
#include "request/names.hpp"

namespace vdwmesh {
namespace {

// Of options, each with whether it was said, the first one that was; empty where none was.
std::string first_said(Door door,
                       std::initializer_list<std::pair<bool, std::string_view>> options) {
  for (const auto& [is_said, name] : options) {
    if (is_said) return option_name(door, name);
  }
  return {};
}

std::string option_of_edges(const MeshRequest& r) {
  return first_said(r.door, {{r.edge_length || !r.edge_lengths.empty(), "edge-length"},
                             {r.grading.relative.has_value(), "relative-edge"},
                             {!r.grading.groups.empty(), "edge-length-of"},
                             {!r.grading.table.empty(), "edge-lengths"}});
}

std::string option_of_grid(const MeshRequest& r) {
  return first_said(r.door, {{r.spacing.has_value(), "spacing"},
                             {r.padding.has_value(), "padding"},
                             {r.fixed_grid, "fixed-grid"}});
}

// The option that asks for marching cubes without naming them: only they have a grid and fields
// other than the union. Empty where none does.
std::string option_of_marching_cubes(const MeshRequest& r) {
  const std::string of_field =
      first_said(r.door, {{r.field != FieldKind::vdw, "field"}, {r.preset.has_value(), "preset"}});
  return of_field.empty() ? option_of_grid(r) : of_field;
}

// A parameter that a field does not have would be silently without effect.
void check_field(const FieldOptions& field, Door door) {
  const bool of_union = field.kind == FieldKind::vdw;
  const auto option = [&](std::string_view name) { return option_name(door, name); };
  const std::string blended = option_with(door, "field", "blinn");
  refuse_if(of_union && field.preset != FieldPreset::radius_aware,
            "{}: is of the blended fields; add {}, soft or inverse-squared",
            refused_option(door, "preset", name_of(field.preset)), blended);
  refuse_if(of_union && field.isovalue, "{}: {} has none; add {}, soft or inverse-squared",
            option("isovalue"), option_with(door, "field", "vdw"), blended);
  refuse_if(field.blobbiness && field.kind != FieldKind::blinn, "{}: {} has none; add {}",
            option("blobbiness"), option_with(door, "field", name_of(field.kind)), blended);
}

// The excluded surface has one mesher, whose edges are all alike. Its meshes are refined to the
// patches without a choice.
void check_excluded(const MeshRequest& r) {
  const std::string excluded = option_with(r.door, "surface", "ses");
  refuse_if(r.mesher == Mesher::marching_cubes, "{}: {} is meshed along its curves, which is {}",
            refused_option(r.door, "mesher", "marching-cubes"), excluded,
            option_with(r.door, "mesher", "exact"));
  const std::string other = first_said(r.door, {{r.grading.relative.has_value(), "relative-edge"},
                                                {!r.grading.groups.empty(), "edge-length-of"},
                                                {!r.grading.table.empty(), "edge-lengths"},
                                                {r.min_angle.has_value(), "min-angle"},
                                                {r.projection.has_value(), "project"},
                                                {r.crossings.has_value(), "crossings"}});
  refuse_if(!other.empty(), "{}: does not go with {}; leave one of them out", other, excluded);
  refuse_if(!r.edge_lengths.empty(), "{}: {} has one for all atoms",
            option_name(r.door, "edge-length"), excluded);
}

// A density or a distance is of the excluded surface, and in place of an edge length and of a
// subdivision.
void check_density(const MeshRequest& r) {
  if (!r.density && !r.max_distance) return;
  const std::string density = option_name(r.door, "density"),
                    distance = option_name(r.door, "max-distance"),
                    asked = r.density ? density : distance;
  refuse_if(r.density && r.max_distance, "{}: {} decides on the triangles; leave one of them out",
            density, distance);
  refuse_if(r.surface != SurfaceChoice::ses, "{}: is of {}; other surfaces take {}", asked,
            option_with(r.door, "surface", "ses"), option_name(r.door, "edge-length"));
  refuse_if(r.edge_length.has_value(), "{}: {} sets the triangles, too; leave one of them out",
            asked, option_name(r.door, "edge-length"));
  refuse_if(r.subdivisions.value_or(0) > 0,
            "{}: does not go with {}; four times the density, or a quarter of the distance, is one "
            "subdivision",
            asked, option_name(r.door, "subdivide"));
}

// Which of its two meshes the excluded surface gets.
void settle_density(SurfaceOptions& s, const MeshRequest& r) {
  if (s.kind != ExactSurface::excluded) return;
  s.density = r.density;
  s.max_distance = r.max_distance;
  if (s.density) s.edge_length = edge_length_of_density(*s.density);
  // About what a surface of the curvature of water's probe needs.
  if (s.max_distance) s.edge_length = std::min(2 * std::sqrt(*s.max_distance), 3.0);
  s.remeshed = s.density || s.max_distance ||
               (s.edge_length.value_or(0) > kLongestAlongCurves && s.subdivisions == 0);
}

// The crease-exact mesher has neither field nor grid.
void check_exact(const MeshRequest& r) {
  const std::string asked = r.surface == SurfaceChoice::ses
                                ? option_with(r.door, "surface", "ses")
                                : option_with(r.door, "mesher", "exact");
  refuse_if(r.field != FieldKind::vdw, "{}: {} is of the spheres themselves, which is {}",
            refused_option(r.door, "field", name_of(r.field)), asked,
            option_with(r.door, "field", "vdw"));
  const std::string of_grid = option_of_grid(r);
  refuse_if(!of_grid.empty(), "{}: {} has no grid; {} sets the size", of_grid, asked,
            option_name(r.door, "edge-length"));
}

void check_cubes(const MeshRequest& r, const std::string& reason) {
  const std::string exact = option_with(r.door, "mesher", "exact");
  const std::string of_edges = option_of_edges(r);
  refuse_if(!of_edges.empty(), "{}: is of {}; marching cubes, which {} asks for, takes {} instead",
            of_edges, exact, reason, option_name(r.door, "spacing"));
  refuse_if(r.min_angle.has_value(),
            "{}: is of {}; marching cubes, which {} asks for, bound no angles",
            option_name(r.door, "min-angle"), exact, reason);
}

// The exact mesher is what people get who ask for nothing else, but where marching cubes are usual.
void settle_mesher(SurfaceOptions& s, const MeshRequest& r) {
  const bool is_excluded = s.kind == ExactSurface::excluded;
  const std::string of_cubes = option_of_marching_cubes(r);
  const std::string of_edges = option_of_edges(r);
  const bool cubes_are_usual = r.usual_mesher == Mesher::marching_cubes;
  const bool is_exact = is_excluded || (of_cubes.empty() && !(cubes_are_usual && of_edges.empty()));
  s.mesher = r.mesher.value_or(is_exact ? Mesher::exact : Mesher::marching_cubes);
  s.mesher_reason = r.mesher                      ? option_name(r.door, "mesher")
                    : is_excluded                 ? option_name(r.door, "surface")
                    : is_exact && cubes_are_usual ? of_edges
                    : of_cubes.empty()            ? "default"
                                                  : of_cubes;
  refuse_if(r.min_angle > kLargestMinAngle, "{}: needs at most {} degrees",
            refused_option(r.door, "min-angle", fmt::format("{}", r.min_angle.value_or(0))),
            kLargestMinAngle);
  if (s.mesher == Mesher::exact) {
    check_exact(r);
  } else {
    check_cubes(r, s.mesher_reason);
  }
}

void note(SurfaceOptions& s, Door door, std::string text) {
  refuse_if(door == Door::python, "{}", text);
  s.notes.push_back(std::move(text));
}

// Projection follows a subdivision. A default that is without effect is nothing to speak of; where
// it was asked for, a note says so.
void settle_projection(SurfaceOptions& s, const MeshRequest& r) {
  const bool of_union = s.field.kind == FieldKind::vdw;
  Projection projection = r.projection.value_or(of_union ? Projection::vdw : Projection::field);
  // The field of --field vdw is the union itself.
  if (of_union && projection == Projection::field) projection = Projection::vdw;
  if (s.subdivisions > 0) {
    s.projection = projection;
  } else if (r.projection && projection != Projection::none) {
    note(s, r.door,
         fmt::format("{} has no effect with {} 0: projection follows a subdivision",
                     refused_option(r.door, "project", name_of(*r.projection)),
                     option_name(r.door, "subdivide")));
  }
}

// Meshes along the creases, and meshes whose vertices do not move, are not searched for crossings.
void settle_crossings(SurfaceOptions& s, const MeshRequest& r) {
  s.crossings = r.crossings.value_or(Crossings::undo);
  if (!r.crossings || s.looks_for_crossings()) return;
  const std::string where = s.mesher == Mesher::exact ? option_with(r.door, "mesher", "exact")
                            : s.subdivisions == 0
                                ? fmt::format("{} 0", option_name(r.door, "subdivide"))
                                : option_with(r.door, "project", "none");
  note(s, r.door,
       fmt::format("{} has no effect with {}: crossings are looked for where a projection moves "
                   "vertices",
                   refused_option(r.door, "crossings", name_of(s.crossings)), where));
}

}  // namespace

// Meshes of marching cubes may be projected once where none is asked for, because their vertices
// lie on edges of the grid's cells, where the surface is only near. Those of the exact mesher lie
// on the surface.
SurfaceOptions settle(const MeshRequest& r) {
  SurfaceOptions s;
  s.kind = surface_of(r.surface);
  if (s.kind == ExactSurface::excluded) check_excluded(r);
  check_density(r);
  s.field = {r.field, r.preset.value_or(FieldPreset::radius_aware), r.isovalue, r.blobbiness};
  check_field(s.field, r.door);
  settle_mesher(s, r);
  s.grading = r.grading, s.edge_lengths = r.edge_lengths, s.min_angle = r.min_angle;
  s.edge_length = r.edge_length;
  if (!s.edge_length && !s.grading.relative) s.edge_length = kUsualEdgeLength;
  s.grid = preset_grid(s.field.preset, r.spacing, r.padding);
  const bool is_exact = s.mesher == Mesher::exact;
  s.subdivisions = r.subdivisions.value_or(is_exact ? 0 : r.subdivisions_of_cubes);
  settle_density(s, r);
  settle_projection(s, r);
  settle_crossings(s, r);
  return s;
}

}  // namespace vdwmesh
