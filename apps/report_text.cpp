// The report laid out for people.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "picture_options.hpp"
#include "printable.hpp"
#include "report.hpp"

namespace vdwmesh::apps {
namespace {

using Text = std::back_insert_iterator<std::string>;

constexpr const char* kNotComputed = "–";

std::string join(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

// "1 subdivision", "2 subdivisions".
std::string counted(std::uint64_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string reason_text(std::string reason) {
  std::replace(reason.begin(), reason.end(), '_', ' ');
  return reason;
}

void line(Text out, std::string_view label, std::string text) {
  fmt::format_to(out, "{:<12} {}\n", label, printable(std::move(text)));
}

std::string atoms_text(const InputReport& input) {
  std::vector<std::string> skipped;
  for (const auto& [reason, count] : input.skipped) {
    if (count > 0) skipped.push_back(fmt::format("{} {}", count, reason_text(reason)));
  }
  const std::string copies =
      input.spheres == input.atoms_used ? "" : fmt::format("; copied to {} spheres", input.spheres);
  return fmt::format("{} used of {} read; left out: {}{}", input.atoms_used, input.atoms_read,
                     skipped.empty() ? "none" : join(skipped), copies);
}

std::string radii_text(const InputReport& input) {
  std::vector<std::string> assumed;
  assumed.reserve(input.radii_assumed.size());
  for (const AssumedRadius& radius : input.radii_assumed) {
    assumed.push_back(
        fmt::format("{} {} Å ({})", radius.element, radius.radius, counted(radius.count, "atom")));
  }
  return fmt::format("{}, probe {} Å; assumed: {}", input.radius_set, input.probe,
                     assumed.empty() ? "none" : join(assumed));
}

void input_text(Text out, const InputReport& input) {
  line(out, "Input",
       fmt::format(
           "{} ({}), model {}, {}", input.path, input.format, input.model,
           input.assembly == "asymmetric" ? "asymmetric unit" : "assembly " + input.assembly));
  line(out, "Atoms", atoms_text(input));
  line(out, "Radii", radii_text(input));
}

std::string refinement_text(const SurfaceOptions& surface) {
  const std::string levels =
      counted(static_cast<std::uint64_t>(surface.subdivisions), "subdivision");
  if (surface.projection == Projection::none) return levels + ", no projection";
  return fmt::format("{}, vertices projected to {}", levels,
                     surface.projection == Projection::vdw ? "the union of the spheres"
                                                           : "the isosurface of the field");
}

std::string surface_text(const ParametersReport& parameters) {
  const FieldOptions& field = parameters.surface.field;
  if (parameters.surface.mesher == Mesher::exact) {
    return fmt::format("union of the spheres, crease-exact, edge length {} Å; {}",
                       parameters.surface.edge_length, refinement_text(parameters.surface));
  }
  std::string text = fmt::format("field {}", field_name(field.kind));
  if (field.kind != FieldKind::vdw) text += fmt::format(" ({})", preset_name(field.preset));
  if (parameters.isovalue) text += fmt::format(", isovalue {}", *parameters.isovalue);
  if (parameters.blobbiness) text += fmt::format(", blobbiness {}", *parameters.blobbiness);
  return text + ", marching cubes; " + refinement_text(parameters.surface);
}

void parameters_text(Text out, const ParametersReport& parameters) {
  line(out, "Surface", surface_text(parameters));
  if (!parameters.grid) return;
  const GridSpec& grid = *parameters.grid;
  line(out, "Grid",
       fmt::format("{} Å, {} × {} × {} = {} cells", grid.spacing, grid.cells.x, grid.cells.y,
                   grid.cells.z, grid.cell_count()));
}

void backend_text(Text out, const BackendReport& backend) {
  std::string text = fmt::format("{}", backend_name(backend.used));
  if (backend.device) text += fmt::format(", {}", *backend.device);
  if (backend.devices > 1) text += fmt::format(" and {} more", backend.devices - 1);
  if (backend.driver) text += fmt::format(", driver {}", *backend.driver);
  text += fmt::format(", {}", counted(static_cast<std::uint64_t>(backend.threads), "CPU thread"));
  if (backend.requested == Backend::automatic) text += "; asked for: auto";
  if (backend.reason)
    text += fmt::format("; {}{}", backend.device ? "" : "no CUDA: ", *backend.reason);
  line(out, "Backend", text);
}

std::string yes_no(bool value, std::string_view noun) {
  return fmt::format("{}{}", value ? "" : "NOT ", noun);
}

// One row of the table in which mesh and exact figures stand side by side.
struct Row {
  std::string label, mesh = kNotComputed, exact = kNotComputed, difference = "", unit = "";
};

std::string length_figure(double value) { return fmt::format("{:.3f}", value); }

template <class T>
std::string figure(const std::optional<T>& value) {
  if (!value) return kNotComputed;
  if constexpr (std::is_floating_point_v<T>) return length_figure(*value);
  return fmt::format("{}", *value);
}

std::string percent(std::optional<double> relative_error) {
  return relative_error ? fmt::format("{:+.3f} %", 100 * *relative_error) : "";
}

template <class T>
std::optional<T> of(const std::optional<UnionTopology>& topology, T UnionTopology::*member) {
  if (!topology) return std::nullopt;
  return (*topology).*member;
}

void fill_mesh(std::vector<Row>& rows, const MeshReport& mesh) {
  const std::optional<std::uint64_t> shells = mesh.topology.shells;
  const std::string column[] = {length_figure(mesh.measures.area),
                                figure(mesh.measures.volume),
                                figure(mesh.measures.outer_area),
                                figure(mesh.measures.void_area),
                                figure(shells),
                                figure(mesh.topology.components),
                                figure(mesh.topology.genus),
                                figure(mesh.topology.voids),
                                fmt::format("{}", mesh.topology.euler_characteristic)};
  for (std::size_t i = 0; i < std::size(column); ++i) rows[i].mesh = column[i];
}

void fill_exact(std::vector<Row>& rows, const ExactUnion& exact) {
  const auto& topology = exact.topology;
  std::optional<std::uint64_t> shells;
  if (topology) shells = topology->shells.size();
  const std::string column[] = {length_figure(exact.area),
                                length_figure(exact.volume),
                                figure(of(topology, &UnionTopology::outer_area)),
                                figure(of(topology, &UnionTopology::void_area)),
                                figure(shells),
                                figure(of(topology, &UnionTopology::components)),
                                figure(of(topology, &UnionTopology::tunnels)),
                                figure(of(topology, &UnionTopology::voids)),
                                figure(of(topology, &UnionTopology::euler_characteristic))};
  for (std::size_t i = 0; i < std::size(column); ++i) rows[i].exact = column[i];
}

// Pads by columns on the screen: "–" and "Å" are one column and several bytes.
std::string padded(const std::string& text, std::size_t width) {
  const auto continuation = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; };
  const std::size_t columns =
      text.size() - static_cast<std::size_t>(std::count_if(text.begin(), text.end(), continuation));
  return std::string(columns < width ? width - columns : 0, ' ') + text;
}

void table_text(Text out, const Report& report) {
  std::vector<Row> rows = {{"Area", "", "", "", "Å²"},
                           {"Volume", "", "", "", "Å³"},
                           {"  outer area", "", "", "", "Å²"},
                           {"  area of voids", "", "", "", "Å²"},
                           {"Shells"},
                           {"Components"},
                           {"Tunnels (genus)"},
                           {"Voids"},
                           {"Euler characteristic"}};
  if (report.mesh) fill_mesh(rows, *report.mesh);
  if (report.exact) fill_exact(rows, *report.exact);
  if (const auto& comparison = report.comparison) {
    rows[0].difference = percent(comparison->area_relative_error);
    rows[1].difference = percent(comparison->volume_relative_error);
    if (const auto chi = comparison->euler_characteristic_difference) {
      rows.back().difference = *chi == 0 ? "equal" : fmt::format("{:+}", *chi);
    }
  }
  fmt::format_to(out, "\n{:<22}{:>14}{:>16}{:>14}\n", "", report.mesh ? "mesh" : "",
                 report.exact ? "exact" : "", report.comparison ? "mesh - exact" : "");
  for (const Row& row : rows) {
    std::string text = fmt::format(
        "{:<22}{}{}{}  {}", row.label, padded(report.mesh ? row.mesh : "", 14),
        padded(report.exact ? row.exact : "", 16), padded(row.difference, 14), row.unit);
    text.erase(text.find_last_not_of(' ') + 1);
    fmt::format_to(out, "{}\n", text);
  }
}

void exact_text(Text out, const ExactUnion& exact) {
  std::string text = fmt::format("method {}", method_name(exact.method));
  if (exact.topology) {
    text += fmt::format("; {} hidden atoms, {} point contacts", exact.topology->hidden_spheres,
                        exact.topology->point_contacts);
  } else {
    text += "; topology not computed";
  }
  if (exact.check_area && exact.check_volume) {
    text += fmt::format("; second formula differs by {:.1e} (area), {:.1e} (volume)",
                        std::abs(*exact.check_area - exact.area) / exact.area,
                        std::abs(*exact.check_volume - exact.volume) / exact.volume);
  }
  if (exact.fallback_spheres > 0) {
    text += fmt::format("; {} atoms by the reference instead of arcs", exact.fallback_spheres);
  }
  line(out, "Exact union", text);
}

void distribution_row(Text out, std::string_view label, const Distribution& d,
                      std::string_view unit) {
  fmt::format_to(out, "{:<22}{:>14.4g}{:>10.4g}{:>10.4g}{:>10.4g}{:>10.4g}{}{}\n", label, d.min,
                 d.p01, d.median, d.p99, d.max, unit.empty() ? "" : "  ", unit);
}

std::string self_intersections_text(const MeshReport& mesh) {
  return mesh.self_intersections ? fmt::format("{} self-intersections", *mesh.self_intersections)
                                 : "self-intersections not computed";
}

std::string cgal_text(const MeshReport& mesh) {
  const CgalMeasures& cgal = *mesh.cgal;
  std::string text = fmt::format("CGAL's measures differ by {:.1e} (area)",
                                 std::abs(cgal.area / mesh.measures.area - 1));
  if (cgal.volume && mesh.measures.volume) {
    text += fmt::format(", {:.1e} (volume)", std::abs(*cgal.volume / *mesh.measures.volume - 1));
  }
  return text;
}

// How each subdivision changed the mesh, the extracted one first.
void levels_text(Text out, const std::vector<LevelReport>& levels) {
  fmt::format_to(out, "\n{:<22}{:>14}{:>12}{:>12}{:>12}{:>12}\n", "Level", "triangles", "angle 1 %",
                 "median", "edge", "crossings");
  for (const LevelReport& level : levels) {
    const std::string crossings =
        level.self_intersections ? std::to_string(*level.self_intersections) : "-";
    fmt::format_to(out, "{:<22}{:>14}{:>12.4g}{:>12.4g}{:>12.4g}{:>12}\n", level.level,
                   level.triangles, level.quality.min_angle_deg.p01,
                   level.quality.min_angle_deg.median, level.quality.edge_length.median, crossings);
  }
}

std::string extrapolated_text(const MeshReport& mesh) {
  std::string text = fmt::format("area {} Å²", length_figure(*mesh.extrapolated_area));
  if (mesh.extrapolated_volume) {
    text += fmt::format(", volume {} Å³", length_figure(*mesh.extrapolated_volume));
  }
  return text + ", from the last two levels";
}

void mesh_text(Text out, const MeshReport& mesh) {
  const MeshTopology& topology = mesh.topology;
  fmt::format_to(out, "\n");
  if (mesh.path) line(out, "Mesh file", *mesh.path);
  line(out, "Mesh",
       fmt::format("{} vertices, {} triangles; {}, {}, {}", topology.vertices, topology.triangles,
                   yes_no(topology.closed, "closed"), yes_no(topology.manifold, "2-manifold"),
                   yes_no(topology.oriented, "oriented")));
  std::string counts = fmt::format("{} degenerate triangles, {}", mesh.quality.degenerate_triangles,
                                   self_intersections_text(mesh));
  if (mesh.clamped_vertices) {
    counts += fmt::format(", {} clamped vertices", *mesh.clamped_vertices);
  }
  if (mesh.arrangement) {
    counts += fmt::format(", {} arcs in {} pieces, {} corners", mesh.arrangement->arcs,
                          mesh.arrangement->pieces, mesh.arrangement->corners);
  }
  if (mesh.grid_clipped) counts += fmt::format(", {} cells cut by the grid", *mesh.grid_clipped);
  line(out, "", counts);
  if (!mesh.projection.empty()) {
    const NewtonSummary newton = summarize(mesh.projection);
    line(out, "Projection",
         fmt::format("{} vertices moved, at most {} steps, residual {:.1e} Å; {} unconverged, {} "
                     "out of reach, {} undone; {} triangles turned",
                     newton.projected, newton.iterations_max, newton.residual_max,
                     newton.unconverged, newton.out_of_reach, newton.undone, newton.turned));
  }
  if (mesh.cgal) line(out, "", cgal_text(mesh));
  if (!mesh.levels.empty()) levels_text(out, mesh.levels);
  if (mesh.extrapolated_area) line(out, "Extrapolated", extrapolated_text(mesh));
  fmt::format_to(out, "\n{:<22}{:>14}{:>10}{:>10}{:>10}{:>10}\n", "", "min", "1 %", "median",
                 "99 %", "max");
  distribution_row(out, "Smallest angle", mesh.quality.min_angle_deg, "degrees");
  distribution_row(out, "Aspect ratio", mesh.quality.aspect_ratio, "");
  distribution_row(out, "Edge length", mesh.quality.edge_length, "Å");
}

void distance_row(Text out, std::string_view label, const DistanceStatistics& d) {
  fmt::format_to(out, "{:<22}{:>14.5f}{:>10.5f}{:>10.5f}{:>10.5f}{:>10.5f}  Å\n", label, d.mean,
                 d.rms, d.p95, d.p99, d.max);
  fmt::format_to(out, "{:<22}{:>14.5f}{:>10.5f}{:>33}\n", "  standard error", d.mean_error,
                 d.rms_error, "Å");
}

void distances_text(Text out, const MeshDistances& distances) {
  fmt::format_to(out, "\n{:<22}{:>14}{:>10}{:>10}{:>10}{:>10}\n", "Distance", "mean", "rms", "95 %",
                 "99 %", "max");
  distance_row(out, "mesh to surface", distances.mesh_to_surface);
  distance_row(out, "surface to mesh", distances.surface_to_mesh);
  fmt::format_to(out, "Hausdorff distance: at least {:.5f} Å ({} samples, seed {})\n",
                 distances.hausdorff_lower_bound, distances.samples, distances.seed);
}

void timing_text(Text out, const Timing& timing) {
  const std::pair<const char*, std::optional<double>> stages[] = {
      {"read", timing.read},       {"field", timing.field},    {"extract", timing.extract},
      {"refine", timing.refine},   {"build", timing.build},    {"exact", timing.exact},
      {"compare", timing.compare}, {"picture", timing.picture}};
  std::string text;
  for (const auto& [name, seconds] : stages) {
    if (seconds) text += fmt::format("{} {:.3f}, ", name, *seconds);
  }
  line(out, "Time (s)", text + fmt::format("total {:.3f}", timing.total));
}

void remarks(Text out, std::string_view label, const std::vector<std::string>& list) {
  for (const std::string& remark : list) line(out, label, remark);
}

}  // namespace

std::string remarks_text(const Report& report) {
  std::string text;
  const Text out(text);
  if (report.mesh) remarks(out, "Note", report.mesh->notes);
  remarks(out, "Note", report.notes);
  remarks(out, "WARNING", report.warnings);
  return text;
}

std::string picture_text(const PictureReport& picture) {
  std::string text;
  const Text out(text);
  line(out, "Picture",
       fmt::format("{}, {} x {} pixels, view {}, {} triangles", picture.path, picture.width,
                   picture.height, picture.view, picture.triangles));
  if (picture.scale) {
    line(out, "",
         fmt::format("{}: {} from {} to {}", picture.scale->title,
                     color_map_name(picture.scale->map), picture.scale->lower,
                     picture.scale->upper));
  }
  line(out, "Drawn by",
       picture.filled_by == Backend::cuda ? picture.device + "; vertex buffers filled by CUDA"
                                          : picture.device);
  return text;
}

std::string to_text(const Report& report) {
  std::string text;
  const Text out(text);
  input_text(out, report.input);
  if (report.parameters) parameters_text(out, *report.parameters);
  if (report.backend) backend_text(out, *report.backend);
  if (report.exact) exact_text(out, *report.exact);
  table_text(out, report);
  if (report.mesh) mesh_text(out, *report.mesh);
  if (report.comparison && report.comparison->distances) {
    distances_text(out, *report.comparison->distances);
  }
  text += '\n';
  if (report.picture) text += picture_text(*report.picture);
  text += remarks_text(report);
  timing_text(out, report.timing);
  return text;
}

}  // namespace vdwmesh::apps
