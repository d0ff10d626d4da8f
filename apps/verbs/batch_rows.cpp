// Members of a row stand in one order, and the error is the last, so that a row can be checked by
// its beginning and its end alone when a file is continued. A row is described once, for JSON and
// for tables.
#include "verbs/batch_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "build_id.hpp"
#include "core/fnv.hpp"
#include "report/csv.hpp"
#include "report/describe_comparison.hpp"
#include "report/json_text.hpp"

namespace vdwmesh::apps {
namespace {

// What no row has: the file of a mesh, as none is written, the time of the mesher, as rows do not
// depend on the machine, and what the excluded surface alone has: patches, a density and an
// exterior surface. JSON has null there.
const std::vector<std::string_view> kNeverKnown{"mesh_path", "mesh_arrangement_seconds",
                                                "mesh_patches_", "mesh_remeshing_",
                                                "comparison_exterior_"};

constexpr std::string_view kNoError = "\"error\":null}\n";

// In a table a row is a line, so names keep no line breaks.
std::string without_breaks(std::string name) {
  for (char& c : name) {
    if (static_cast<unsigned char>(c) < ' ') c = '?';
  }
  return name;
}

template <class A>
void describe_figures(A& a, const BatchRow& row) {
  a("atoms", row.atoms), a("left_out", row.left_out);
  a("assumed_radii", row.assumed_radii), a("guessed_elements", row.guessed_elements);
  a("method", row.method), a("area", row.area), a("volume", row.volume);
  a("components", row.components), a("tunnels", row.tunnels), a("voids", row.voids);
  a("euler_characteristic", row.euler_characteristic);
  a("fallback_spheres", row.fallback_spheres), a("doubtful_spheres", row.doubtful_spheres);
}

template <class A>
void describe_figures(A& a, const ExcludedRow& row) {
  describe_figures(a, static_cast<const BatchRow&>(row));
  a("excluded", row.excluded);
}

template <class A>
void describe_figures(A& a, const ReportRow& row) {
  describe_figures(a, static_cast<const BatchRow&>(row));
  a("mesh", row.mesh), a("comparison", row.comparison);
}

// How the sides fit where they bury most, and the contact surface of all. Rows have it where it was
// asked for.
template <class A>
void describe_fit(A& a, const InterfaceRow& row) {
  std::optional<double> sc, error, surface;
  if (row.interfaces && !row.interfaces->empty()) {
    const auto& most = std::ranges::max(*row.interfaces, {}, &InterfaceReport::buried_area);
    sc = most.complementarity->sc, error = most.complementarity->error;
  }
  if (row.interfaces) {
    surface = 0;
    for (const InterfaceReport& i : *row.interfaces)
      *surface += i.complementarity->contact_a + i.complementarity->contact_b;
  }
  a("sc", sc), a("sc_error", error), a("contact_surface", surface);
}

// A table has their number and sums.
template <class A>
void describe_figures(A& a, const InterfaceRow& row) {
  std::optional<std::uint64_t> count;
  std::optional<double> buried, contact;
  if (row.interfaces) {
    count = row.interfaces->size();
    buried = contact = 0;
    for (const InterfaceReport& i : *row.interfaces)
      *buried += i.buried_area, *contact += i.contact_area;
  }
  describe_figures(a, static_cast<const BatchRow&>(row));
  a("interface_count", count), a("buried_area", buried), a("contact_area", contact);
  a("interfaces", row.interfaces);
  if (row.fit == Switch::on) describe_fit(a, row);
}

// A table has their number and sums over them.
template <class A>
void describe_figures(A& a, const PocketsRow& row) {
  std::optional<std::uint64_t> count;
  std::optional<double> volume, volume_sum, open;
  if (row.pockets) {
    const bool exact = row.measures == PocketMeasures::exact;
    count = row.pockets->pockets.size();
    volume_sum = 0;
    if (exact) volume = open = 0;
    for (const PocketRow& p : row.pockets->pockets) {
      *volume_sum += p.volume_sum;
      if (exact) *volume += p.volume, *open += sum_over_mouths(p, &Mouth::area);
    }
  }
  describe_figures(a, static_cast<const BatchRow&>(row));
  a("pocket_count", count), a("pocket_volume", volume), a("pocket_volume_sum", volume_sum);
  a("mouth_area", open), a("pockets", row.pockets);
}

template <class Row>
std::string json_row(const Row& row, const std::string& settings) {
  JsonText json(JsonText::Layout::compact);
  json("name", row.name), json("settings", settings), json("content", row.content);
  describe_figures(json, row);
  json("warnings", row.warnings), json("error", row.error);
  return std::move(json).take();
}

template <class Row>
Cells csv_row(const Row& row, const std::string& settings) {
  Cells csv(csv_number, kNeverKnown);
  csv("name", without_breaks(row.name)), csv("settings", settings), csv("content", row.content);
  describe_figures(csv, row);
  csv("warnings", row.warnings.size()), csv("error", row.error);
  return csv;
}

template <class Row>
std::string line_of(const Row& row, RowFormat format, const std::string& settings) {
  std::string line =
      format == RowFormat::csv ? csv_row(row, settings).values() : json_row(row, settings);
  while (!line.empty() && line.back() == '\n') line.pop_back();
  return line + '\n';
}

// What a mesh and its comparison depend on.
std::string mesh_settings(const Options& o) {
  const SurfaceOptions& s = o.surface;
  const FieldOptions& f = s.field;
  const auto or_none = [](const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string("-");
  };
  return fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}",
                     name_of(s.mesher), or_none(s.edge_length), or_none(s.grading.relative),
                     fmt::join(s.grading.groups, "\n"), or_none(s.min_angle), name_of(f.kind),
                     name_of(f.preset), or_none(f.isovalue), or_none(f.blobbiness), s.grid.spacing,
                     or_none(s.grid.padding), s.subdivisions, name_of(s.projection),
                     name_of(s.crossings), name_of(o.self_intersections), name_of(o.cgal_check),
                     name_of(o.distances.distances), o.distances.samples_per_area,
                     o.distances.seed);
}

// The files that --radii names: the whole of it, or what stands between its commas.
std::vector<std::string> radius_files(const std::string& radii) {
  std::vector<std::string> files{radii};
  std::istringstream parts(radii);
  for (std::string part; std::getline(parts, part, ',');) files.push_back(part);
  std::erase_if(files, [](const std::string& file) {
    std::error_code error;
    return !std::filesystem::is_regular_file(file, error);
  });
  return files;
}

}  // namespace

RowWriter::RowWriter(const Options& options)
    : verb_(options.batch.verb),
      surface_(options.exact.surface),
      format_(options.batch.rows),
      fit_(options.distances.distances),
      settings_(settings_key(options)) {}

std::string RowWriter::header() const {
  if (format_ != RowFormat::csv) return {};
  if (verb_ == BatchVerb::report) return csv_row(ReportRow{}, "").names() + '\n';
  if (verb_ == BatchVerb::interface) {
    InterfaceRow row;
    row.fit = fit_;
    return csv_row(row, "").names() + '\n';
  }
  if (verb_ == BatchVerb::pockets) return csv_row(PocketsRow{}, "").names() + '\n';
  if (surface_ == ExactSurface::excluded) return csv_row(ExcludedRow{}, "").names() + '\n';
  return csv_row(BatchRow{}, "").names() + '\n';
}

std::string RowWriter::text(const BatchRow& row) const { return line_of(row, format_, settings_); }

std::string RowWriter::text(const ExcludedRow& row) const {
  return line_of(row, format_, settings_);
}

std::string RowWriter::text(const ReportRow& row) const { return line_of(row, format_, settings_); }

std::string RowWriter::text(const InterfaceRow& row) const {
  return line_of(row, format_, settings_);
}

std::string RowWriter::text(const PocketsRow& row) const {
  return line_of(row, format_, settings_);
}

std::string RowWriter::beginning(const std::string& name) const {
  if (format_ == RowFormat::csv) return csv_field(without_breaks(name)) + ',' + settings_ + ',';
  BatchRow row;
  row.name = name;
  const std::string line = json_row(row, settings_);
  return line.substr(0, line.find("\"content\":", line.find(settings_)));
}

std::string RowWriter::content(const std::optional<std::string>& content) const {
  if (format_ == RowFormat::csv) return content.value_or("") + ',';
  return content ? fmt::format("\"content\":\"{}\",", *content) : "\"content\":null,";
}

bool RowWriter::is_refusal(std::string_view line) const {
  return !line.ends_with(format_ == RowFormat::csv ? std::string_view(",\n") : kNoError);
}

std::string settings_key(const Options& options) {
  const InputOptions& input = options.inputs.front();
  const ReadOptions& r = input.read;
  std::string all = fmt::format(
      "{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", kRevision, name_of(r.format),
      name_of(r.unit), r.model, r.assembly, r.select, r.measure, static_cast<int>(r.waters),
      static_cast<int>(r.hydrogens), static_cast<int>(r.hetero_atoms), r.altloc, r.radii,
      input.probe, name_of(options.exact.method), name_of(options.exact.topology));
  for (const std::string& file : radius_files(r.radii)) {
    all += '\n' + content_of({file, std::nullopt, ""}).value_or("");
  }
  if (options.exact.surface == ExactSurface::excluded) all += "\nexcluded";
  if (options.batch.verb == BatchVerb::report) all += '\n' + mesh_settings(options);
  if (options.batch.verb == BatchVerb::interface)
    all += fmt::format("\ninterface\n{}\n{}\n{}", name_of(options.distances.distances),
                       options.distances.samples_per_area, options.distances.seed);
  if (options.batch.verb == BatchVerb::pockets)
    all += fmt::format("\npockets\n{}", static_cast<int>(options.pocket_measures));
  return fmt::format("{:016x}", fnv1a(all));
}

}  // namespace vdwmesh::apps
