// One row per run.
#include <fmt/format.h>

#include <utility>

#include "csv.hpp"
#include "study/records.hpp"
#include "study/study.hpp"

namespace vdwmesh::apps {
namespace {

// A column: its name, and what it holds for a run. Header and rows come from the same list.
using Columns = std::vector<std::pair<std::string, std::string>>;

class Row {
 public:
  void text(const char* name, std::string_view value) {
    columns_.emplace_back(name, csv_field(std::string(value)));
  }
  void number(std::string name, const std::optional<double>& value) {
    columns_.emplace_back(std::move(name), csv_number(value));
  }
  template <class T>
  void count(const char* name, const std::optional<T>& value) {
    columns_.emplace_back(name, csv_count(value));
  }
  void yes_no(const char* name, bool value) {
    columns_.emplace_back(name, value ? "true" : "false");
  }
  void distribution(const std::string& name, const Distribution& d) {
    number(name + "_min", d.min), number(name + "_p01", d.p01), number(name + "_median", d.median);
    number(name + "_p99", d.p99), number(name + "_max", d.max);
  }
  void distances(const std::string& name, const std::optional<DistanceStatistics>& d) {
    const auto read = [&](auto member) {
      return d ? std::optional<double>((*d).*member) : std::nullopt;
    };
    number(name + "_mean", read(&DistanceStatistics::mean));
    number(name + "_rms", read(&DistanceStatistics::rms));
    number(name + "_max", read(&DistanceStatistics::max));
  }
  Columns take() && { return std::move(columns_); }

 private:
  Columns columns_;
};

void add_setting(Row& row, const StudySetting& setting) {
  row.text("mesher", mesher_name(setting.key.mesher));
  row.text("field", field_name(setting.key.field));
  row.text("project", projection_name(setting.key.projection));
  row.text("subdivide", std::to_string(setting.key.subdivisions));
  row.number("resolution", setting.resolution);
  row.text("backend", setting.key.backend);
}

void add_topology(Row& row, const MeshTopology& t) {
  row.text("vertices", std::to_string(t.vertices));
  row.text("triangles", std::to_string(t.triangles));
  row.text("euler_characteristic", std::to_string(t.euler_characteristic));
  row.text("shells", std::to_string(t.shells));
  row.count("components", t.components), row.count("voids", t.voids), row.count("genus", t.genus);
  row.yes_no("closed", t.closed), row.yes_no("manifold", t.manifold);
  row.yes_no("oriented", t.oriented);
}

void add_distances(Row& row, const std::optional<MeshDistances>& distances) {
  std::optional<DistanceStatistics> there, back;
  std::optional<double> hausdorff;
  if (distances) {
    there = distances->mesh_to_surface;
    back = distances->surface_to_mesh;
    hausdorff = distances->hausdorff_lower_bound;
  }
  row.distances("mesh_to_surface", there);
  row.distances("surface_to_mesh", back);
  row.number("hausdorff_lower_bound", hausdorff);
}

void add_costs(Row& row, const StudyRun& run) {
  row.number("seconds_field", run.seconds.field);
  row.number("seconds_extract", run.seconds.extract);
  row.number("seconds_refine", run.seconds.refine);
  row.number("seconds_mesh", run.seconds.mesh);
  row.number("seconds_distances", run.seconds.distances);
  row.text("mesh_bytes", std::to_string(run.memory.mesh));
  row.count("peak_bytes", run.memory.peak);
}

Columns columns_of(const StudyInput& input, const StudyRun& run) {
  Row row;
  row.text("input", input.name);
  row.text("atoms", std::to_string(input.report.atoms_used));
  add_setting(row, run.setting);
  add_topology(row, run.topology);
  row.number("area", run.measures.area), row.number("exact_area", input.exact.area);
  row.number("area_relative_error", run.comparison.area_relative_error);
  row.number("volume", run.measures.volume), row.number("exact_volume", input.exact.volume);
  row.number("volume_relative_error", run.comparison.volume_relative_error);
  row.count("euler_characteristic_difference", run.comparison.euler_characteristic_difference);
  row.count("self_intersections", run.self_intersections);
  row.distribution("min_angle_deg", run.quality.min_angle_deg);
  row.distribution("aspect_ratio", run.quality.aspect_ratio);
  row.distribution("edge_length", run.quality.edge_length);
  add_distances(row, run.comparison.distances);
  add_costs(row, run);
  return std::move(row).take();
}

void print(const Columns& columns, std::string Columns::value_type::*part, std::string& csv) {
  const char* separator = "";
  for (const auto& column : columns) {
    csv += separator;
    csv += column.*part;
    separator = ",";
  }
  csv += '\n';
}

}  // namespace

std::string study_csv(const Study& study) {
  using Column = Columns::value_type;
  std::string csv;
  print(columns_of(StudyInput{}, StudyRun{}), &Column::first, csv);
  for (const StudyFindings& f : study.findings) {
    for (const StudyRun& run : f.runs) print(columns_of(f.input, run), &Column::second, csv);
  }
  return csv;
}

}  // namespace vdwmesh::apps
