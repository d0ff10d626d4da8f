// Lays the report out for people: the answer (answer_text.cpp) with notes and warnings, and between
// them, where more text is asked for, one line per matter and tables where figures stand side by
// side. There, what was not computed is a dash or left out. The table of mesh and exact union takes
// its figures from the description that the JSON is made of.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "command_line/names.hpp"
#include "report/csv.hpp"
#include "report/describe_report.hpp"
#include "report/report.hpp"
#include "report/report_text_parts.hpp"

namespace vdwmesh::apps {
namespace {

constexpr const char* kNotComputed = "–";

std::string in_words(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

// In words, because "vdw" and "field" say little to those who do not know the options.
std::string refinement_text(const SurfaceOptions& surface) {
  const std::string levels =
      counted(static_cast<std::uint64_t>(surface.subdivisions), "subdivision");
  if (surface.projection == Projection::none) return levels + ", no projection";
  const bool crosses = surface.looks_for_crossings() && surface.crossings == Crossings::allow;
  return fmt::format("{}, vertices projected to {}{}", levels,
                     surface.projection == Projection::vdw ? "the union of the spheres"
                                                           : "the isosurface of the field",
                     crosses ? ", crossings allowed" : "");
}

std::string edge_text(const SurfaceOptions& surface) {
  const EdgeGrading& grading = surface.grading;
  std::string text;
  if (surface.edge_length) text = fmt::format(", edge length {} Å", *surface.edge_length);
  if (grading.relative) text += fmt::format(", edges of {} radii", *grading.relative);
  for (const std::string& group : grading.groups) text += fmt::format(", {} Å", group);
  if (!grading.table.empty()) text += ", edge lengths of " + grading.table;
  if (surface.min_angle) text += fmt::format(", angles from {}°", *surface.min_angle);
  return text.substr(2);
}

std::string surface_text(const ParametersReport& parameters) {
  const FieldOptions& field = parameters.surface.field;
  if (parameters.surface.kind == ExactSurface::excluded) {
    const SurfaceOptions& surface = parameters.surface;
    if (surface.remeshed) {
      return "solvent-excluded surface across the curves between its patches, " +
             (surface.density        ? fmt::format("{} triangles per Å²", *surface.density)
              : surface.max_distance ? fmt::format("within {} Å of it", *surface.max_distance)
                                     : edge_text(surface));
    }
    return "solvent-excluded surface along the curves between its patches, " + edge_text(surface) +
           "; " + counted(static_cast<std::uint64_t>(surface.subdivisions), "subdivision");
  }
  if (parameters.surface.mesher == Mesher::exact) {
    return fmt::format("union of the spheres, crease-exact, {}; {}", edge_text(parameters.surface),
                       refinement_text(parameters.surface));
  }
  std::string text = fmt::format("field {}", name_of(field.kind));
  if (field.kind != FieldKind::vdw) text += fmt::format(" ({})", name_of(field.preset));
  if (parameters.isovalue) text += fmt::format(", isovalue {}", *parameters.isovalue);
  if (parameters.blobbiness) text += fmt::format(", blobbiness {}", *parameters.blobbiness);
  const std::string& reason = parameters.surface.mesher_reason;
  text += ", marching cubes";
  if (!reason.empty()) text += fmt::format(" (of {})", reason);
  return text + "; " + refinement_text(parameters.surface);
}

void parameters_text(Text out, const ParametersReport& parameters) {
  line(out, "Surface", surface_text(parameters));
  if (!parameters.grid) return;
  const GridSpec& grid = *parameters.grid;
  line(out, "Grid",
       fmt::format("{} Å, {} × {} × {} = {} cells", grid.spacing, grid.cells.x, grid.cells.y,
                   grid.cells.z, grid.cell_count()));
}

// Who made the mesh, and why that is not a device where one might expect it.
void backend_text(Text out, const BackendReport& backend) {
  std::string text = fmt::format("{}", name_of(backend.used));
  if (backend.device) text += fmt::format(", {}", *backend.device);
  if (backend.devices > 1) text += fmt::format(" and {} more", backend.devices - 1);
  if (backend.driver) text += fmt::format(", driver {}", *backend.driver);
  text += fmt::format(", {}", counted(static_cast<std::uint64_t>(backend.threads), "CPU thread"));
  if (backend.requested == Backend::automatic) text += "; asked for: auto";
  if (backend.reason)
    text += fmt::format("; {}{}", backend.device ? "" : "no CUDA: ", *backend.reason);
  line(out, "Backend", text);
}

std::string on_the_right(const std::string& text, std::size_t width) {
  return blanks(width, text) + text;
}

// The figures of a block of the report, by their keys; none where the report lacks it.
template <class Block>
std::optional<Cells> figures_of(const std::optional<Block>& block) {
  if (!block) return std::nullopt;
  Cells cells(figure_text);
  describe(cells, *block);
  return cells;
}

// The exact figures of the table: those of the union or, in its place, of the complete excluded
// surface.
std::optional<Cells> exact_figures_of(const Report& report) {
  if (!report.excluded) return figures_of(report.exact);
  const ExcludedSurface& s = report.excluded->complete;
  Cells cells(figure_text);
  cells("area", s.area), cells("volume", s.volume);
  if (!s.topology) return cells;
  const ShellFigures figures = shell_figures(*s.topology);
  cells("outer_area", figures.outer_area), cells("void_area", figures.wall_area);
  cells("shells", figures.outer + figures.walls), cells("components", figures.outer);
  cells("tunnels", figures.genus), cells("voids", figures.walls);
  cells("euler_characteristic", s.topology->euler_characteristic);
  return cells;
}

// A figure that was not computed is a dash, and nothing stands in the column of a lacking block.
std::string figure(const std::optional<Cells>& figures, const char* key) {
  if (!figures) return "";
  const std::string text = (*figures)[key];
  return text.empty() ? kNotComputed : text;
}

// A row of the table: what it is called, and the keys of its figures in mesh and exact union. A
// mesh has no polarity: rows without a key of it stand there only if the exact union has the
// figure.
struct TableRow {
  const char *label, *mesh, *exact, *unit;
};
constexpr TableRow kTableRows[] = {
    {"Area", "area", "area", "Å²"},
    {"  polar area", nullptr, "polar_area", "Å²"},
    {"  apolar area", nullptr, "apolar_area", "Å²"},
    {"  unclassified area", nullptr, "unclassified_area", "Å²"},
    {"Volume", "volume", "volume", "Å³"},
    {"  outer area", "outer_area", "outer_area", "Å²"},
    {"  area of voids", "void_area", "void_area", "Å²"},
    {"Shells", "shells", "shells", ""},
    {"Components", "components", "components", ""},
    {"Tunnels (genus)", "genus", "tunnels", ""},
    {"Voids", "voids", "voids", ""},
    {"Euler characteristic", "euler_characteristic", "euler_characteristic", ""}};

// Mesh and exact surface side by side, and how far they are apart.
void table_text(Text out, const Report& report) {
  const std::optional<Cells> mesh = figures_of(report.mesh), exact = exact_figures_of(report);
  std::map<std::string_view, std::string> differences;
  if (const auto& comparison = report.comparison) {
    differences["area"] = percent(comparison->area_relative_error);
    differences["volume"] = percent(comparison->volume_relative_error);
    differences["euler_characteristic"] = equal_or(comparison->euler_characteristic_difference);
  }
  fmt::format_to(out, "\n{:<22}{:>14}{:>16}{:>14}\n", "", mesh ? "mesh" : "", exact ? "exact" : "",
                 report.comparison ? "mesh - exact" : "");
  for (const TableRow& row : kTableRows) {
    if (!row.mesh && (!exact || (*exact)[row.exact].empty())) continue;
    std::string text = fmt::format(
        "{:<22}{}{}{}  {}", row.label, on_the_right(row.mesh ? figure(mesh, row.mesh) : "", 14),
        on_the_right(figure(exact, row.exact), 16),
        on_the_right(row.mesh ? differences[row.mesh] : "", 14), row.unit);
    text.erase(text.find_last_not_of(' ') + 1);
    fmt::format_to(out, "{}\n", text);
  }
}

// The atoms that --measure chose may be buried: of an area of 0, the difference itself.
double relative_difference(double check, double value) {
  const double difference = std::abs(check - value);
  return value == 0 ? difference : difference / value;
}

void exact_text(Text out, const ExactReport& exact) {
  std::string text = fmt::format("method {}", name_of(exact.method));
  if (exact.backend == Backend::cuda) text += " on cuda";
  if (exact.topology) {
    text += fmt::format("; {} hidden atoms, {} point contacts", exact.topology->hidden_spheres,
                        exact.topology->point_contacts);
  } else if (exact.counts) {
    text += fmt::format("; {} hidden atoms; of the topology, counts alone",
                        exact.counts->hidden_spheres);
  } else {
    text += "; topology not computed";
  }
  if (exact.check_area && exact.check_volume) {
    text += fmt::format("; arcs differ by {:.1e} (area), {:.1e} (volume)",
                        relative_difference(*exact.check_area, exact.area),
                        relative_difference(*exact.check_volume, exact.volume));
  }
  if (exact.fallback_spheres > 0) {
    text += fmt::format("; {} atoms by the reference instead of arcs", exact.fallback_spheres);
  }
  line(out, "Exact union", text);
  if (const auto& c = exact.certificate)
    line(
        out, "",
        fmt::format("{} atoms needed more than double, at most {} bits", c->wide_spheres, c->bits));
}

// The two surfaces side by side.
void excluded_text(Text out, const ExcludedMeasures& excluded) {
  const ExcludedSurface& s = excluded.complete;
  const auto& outside = excluded.exterior;
  line(out, "Excluded",
       fmt::format("{} probes, {} low, {} crowded; {} arcs, {} of them spindles, {} rings",
                   s.counts.probes, s.counts.low_probes, s.counts.crowded_probes, s.counts.arcs,
                   s.counts.spindle_saddles, s.counts.whole_rings));
  line(
      out, "",
      fmt::format("not closed by {:.1e} of the area; second formula differs by {:.1e} (volume); {} "
                  "patches decided by wide numbers, {} ties, {} not certified",
                  s.checks.closure, relative_difference(s.checks.check_volume, s.volume),
                  s.checks.extended_decisions, s.checks.ties, s.checks.uncertified_patches));
  fmt::format_to(out, "\n{:<22}{:>16}{:>16}\n", "", "complete", outside ? "exterior" : "");
  const auto row = [&](const char* label, const auto& value, const char* unit) {
    fmt::format_to(out, "{:<22}{:>16.3f}{:>16}  {}\n", label, value(s),
                   outside ? fmt::format("{:.3f}", value(*outside)) : "", unit);
  };
  using S = ExcludedSurface;
  row(
      "Area", [](const S& x) { return x.area; }, "Å²");
  row(
      "  contact", [](const S& x) { return x.area_by_kind.contact; }, "Å²");
  row(
      "  saddle", [](const S& x) { return x.area_by_kind.saddle; }, "Å²");
  row(
      "  concave", [](const S& x) { return x.area_by_kind.concave; }, "Å²");
  row(
      "Volume", [](const S& x) { return x.volume; }, "Å³");
  if (!s.topology) {
    if (s.euler_characteristic) {
      fmt::format_to(out, "{:<22}{:>16}\n", "Euler characteristic", *s.euler_characteristic);
    }
    return;
  }
  const auto count = [&](const char* label, const auto& value) {
    fmt::format_to(out, "{:<22}{:>16}{:>16}\n", label, value(*s.topology),
                   outside ? fmt::to_string(value(*outside->topology)) : "");
  };
  using T = ExcludedTopology;
  count("Shells", [](const T& t) { return t.shells.size(); });
  count("  walls of cavities", [](const T& t) { return t.cavities; });
  count("Euler characteristic", [](const T& t) { return t.euler_characteristic; });
}

// The largest first; most people look at a few of a large complex.
void interfaces_text(Text out, std::vector<InterfaceReport> interfaces) {
  constexpr std::size_t kMostRows = 24;
  const auto buried = [](const InterfaceReport& i) { return i.buried_area; };
  std::ranges::stable_sort(interfaces, std::greater(), buried);
  const std::size_t shown = std::min(interfaces.size(), kMostRows);
  fmt::format_to(out, "\n{:<22}{:>14}{:>12}{:>12}{:>14}{:>10}{:>10}\n", "Interface", "buried Å²",
                 "of the 1st", "of the 2nd", "contacts Å²", "atoms", "residues");
  for (const InterfaceReport& i : std::span(interfaces).first(shown)) {
    const auto& [a, b] = std::tie(i.side_a, i.side_b);
    const std::string name = printable(fmt::format("{} with {}", i.a, i.b));
    fmt::format_to(out, "{:<22}{:>13.3f}{:>12.3f}{:>12.3f}{:>13.3f}{:>10}{:>10}\n", name,
                   i.buried_area, a.buried_area, b.buried_area, i.contact_area, a.atoms + b.atoms,
                   a.residues + b.residues);
    if (i.buried_by_polarity)
      fmt::format_to(out, "{:<22}{:>13.3f} polar, {:.3f} apolar\n", "", i.buried_by_polarity->polar,
                     i.buried_by_polarity->apolar);
    if (i.excluded)
      fmt::format_to(out, "{:<22}{:>13.3f} of the excluded surface, gap {:.3f} Å³\n", "",
                     i.excluded->buried_a + i.excluded->buried_b, i.excluded->gap_volume);
    if (i.complementarity && std::isfinite(i.complementarity->sc))
      fmt::format_to(out, "{:<22}{:>13.4f} ± {:.4f} shape complementarity\n", "",
                     i.complementarity->sc, i.complementarity->error);
    else if (i.complementarity)
      fmt::format_to(out, "{:<22}{:>13} shape complementarity: a side has no fitted part\n", "",
                     "no");
  }
  if (shown < interfaces.size())
    fmt::format_to(out, "and {} smaller ones, which --json lists\n", interfaces.size() - shown);
}

// Stages that did not run are left out.
std::string seconds_text(const Seconds& all) {
  std::vector<std::string> parts;
  for (const auto& [name, seconds] : all.stages) {
    if (seconds) parts.push_back(fmt::format("{} {:.3f}", in_words(name), *seconds));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
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

std::string timing_text(const Timing& timing) {
  std::string text;
  const Text out(text);
  line(out, "Time (s)", seconds_text(wall_seconds(timing)));
  line(out, "CPU (s)", seconds_text(cpu_seconds(timing)));
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
         fmt::format("{}: {} from {:.6g} to {:.6g}", picture.scale->title,
                     name_of(picture.scale->map), picture.scale->lower, picture.scale->upper));
  }
  line(out, "Drawn by", picture.device);
  return text;
}

namespace {

// How the figures came about, and whether to trust them.
void details_text(Text out, const Report& report) {
  if (report.parameters) parameters_text(out, *report.parameters);
  if (report.backend) backend_text(out, *report.backend);
  if (report.exact) exact_text(out, *report.exact);
  if (report.excluded) excluded_text(out, *report.excluded);
  if (report.exact || report.mesh) table_text(out, report);
  if (report.mesh) mesh_text(out, *report.mesh);
  if (!report.comparison) return;
  if (report.comparison->proof) proof_text(out, *report.comparison, *report.mesh);
  if (report.comparison->distances) distances_text(out, *report.comparison);
  if (report.comparison->exterior) exterior_text(out, *report.comparison->exterior);
}

}  // namespace

std::string to_text(const Report& report, Verbosity verbosity) {
  std::string text;
  const Text out(text);
  answer_text(out, report);
  if (report.pockets) text += pocket_text(*report.pockets);
  if (report.scan) text += scan_text(*report.scan);
  if (report.shell) text += shell_text(*report.shell);
  if (report.way) text += way_text(*report.way);
  if (report.interfaces) interfaces_text(out, *report.interfaces);
  if (verbosity == Verbosity::verbose) {
    text += '\n';
    details_text(out, report);
    text += '\n';
  }
  if (report.picture) text += picture_text(*report.picture);
  text += remarks_text(report);
  if (verbosity == Verbosity::verbose) text += timing_text(report.timing);
  return text;
}

}  // namespace vdwmesh::apps
