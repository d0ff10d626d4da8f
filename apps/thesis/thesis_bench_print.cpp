// The rerun tables as text, CSV and JSON.
#include <fmt/format.h>

#include <iterator>
#include <set>

#include "build_id.hpp"
#include "csv.hpp"
#include "json_writer.hpp"
#include "thesis/thesis_bench.hpp"

namespace vdwmesh::apps {
namespace {

using Text = std::back_insert_iterator<std::string>;

constexpr std::pair<const char*, const char*> kTitles[] = {
    {"4.1", "marching cubes on the CPU, the thesis's program without a hash table"},
    {"4.2", "marching cubes on the CPU, the thesis's program with a hash table"},
    {"4.3", "marching cubes on the GPU"},
    {"4.4", "van der Waals surface on the CPU, inverse squared function"},
    {"4.5", "van der Waals surface on the GPU, inverse squared function"}};

std::uint64_t voxels_of(const ThesisBenchRow& row) {
  return static_cast<std::uint64_t>(row.grid.x * row.grid.y * row.grid.z);
}

bool is_stand_in(const ThesisBenchRow& row) {
  return row.structure && row.structure->kind == ThesisStructure::Kind::stand_in;
}

std::string or_dash(const std::optional<double>& value, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value) : "-";
}
std::string or_dash(const std::optional<std::uint64_t>& value) {
  return value ? fmt::format("{}", *value) : "-";
}

std::string label_of(const ThesisBenchRow& row) {
  return is_stand_in(row) ? fmt::format("{} for {}", row.structure->id, row.entry.id)
                          : row.entry.id;
}

void print_header(Text out, const std::string& table) {
  for (const auto& [name, title] : kTitles) {
    if (table == name) fmt::format_to(out, "\nTable {}: {}\n", name, title);
  }
  const bool gpu = is_gpu_table(table);
  fmt::format_to(
      out, "{:<20} {:<15} | {:>16} | {:>15} {:>6} | {:>9} {:>10} {:>10} {:>10} | {:>8} {:>8}\n", "",
      "", "voxels", "triangles", "", "thesis's", gpu ? "" : "its program",
      gpu ? "our" : "ours, one", gpu ? "atoms to" : "ours as", "thesis's", "per");
  fmt::format_to(out,
                 "{:<20} {:<15} | {:>8} {:>7} | {:>7} {:>7} {:>6} | {:>9} {:>10} {:>10} {:>10} | "
                 "{:>8} {:>8}\n",
                 "entry", "", "thesis", "ours", "thesis", "ours", "ratio", "s",
                 gpu ? "" : "today, s", gpu ? "kernels, s" : "thread, s",
                 gpu ? "mesh, s" : "it runs, s", "s / ours", "triangle");
}

void print_row(Text out, const ThesisBenchRow& row) {
  const bool gpu = is_gpu_table(row.table);
  const ThesisTimes& s = row.seconds;
  fmt::format_to(out,
                 "{:<20} {:<15} | {:>8} {:>7} | {:>7} {:>7} {:>6} | {:>9} {:>10} {:>10} {:>10} | "
                 "{:>8} {:>8}\n",
                 label_of(row), row.column, row.entry.voxels, voxels_of(row), row.thesis.triangles,
                 or_dash(row.triangles), or_dash(triangles_ratio(row), "{:.3f}"),
                 row.thesis.seconds, gpu ? "" : or_dash(s.program, "{:.4f}"),
                 gpu ? or_dash(s.kernels, "{:.6f}") : or_dash(s.one_thread, "{:.4f}"),
                 or_dash(s.all, gpu ? "{:.6f}" : "{:.4f}"), or_dash(seconds_ratio(row), "{:.1f}"),
                 or_dash(per_triangle_ratio(row), "{:.1f}"));
}

std::string joined(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

void print_notes(Text out, const ThesisBench& bench) {
  std::set<std::string> missing, stand_ins;
  bool gpu = false;
  for (const ThesisBenchRow& row : bench.rows) {
    if (!row.structure) missing.insert(row.entry.id);
    if (is_stand_in(row)) stand_ins.insert(label_of(row));
    gpu |= is_gpu_table(row.table);
  }
  fmt::format_to(
      out, "\nThe thesis's seconds are of a Q9550 (4.1, 4.2, 4.4) and a GTX 280 (4.3, 4.5).\n");
  fmt::format_to(out, "Ours as it runs on the CPU: {} threads.\n", bench.threads);
  if (gpu && bench.device) {
    fmt::format_to(out, "CUDA: {}, driver {}.\n", *bench.device, bench.driver.value_or("unknown"));
  } else if (gpu) {
    fmt::format_to(out, "Tables 4.3 and 4.5 did not run: {}.\n", bench.no_device);
  }
  if (!stand_ins.empty()) {
    fmt::format_to(
        out,
        "Stand-ins, other molecules than the thesis's, so only seconds per triangle compare: {}.\n",
        joined(stand_ins));
  }
  if (!missing.empty()) fmt::format_to(out, "Missing, no structure file: {}.\n", joined(missing));
}

Json row_json(const ThesisBenchRow& row) {
  const bool ran = row.structure.has_value();
  return {{"table", row.table},
          {"column", row.column},
          {"thesis",
           {{"entry", row.entry.id},
            {"atoms", row.entry.atoms},
            {"voxels", row.entry.voxels},
            {"triangles", row.thesis.triangles},
            {"seconds", row.thesis.seconds}}},
          {"structure", ran ? Json(row.structure->id) : Json(nullptr)},
          {"stand_in", is_stand_in(row)},
          {"missing", !ran},
          {"atoms", ran ? Json(row.atoms) : Json(nullptr)},
          {"grid", ran ? Json({row.grid.x, row.grid.y, row.grid.z}) : Json(nullptr)},
          {"voxels", ran ? Json(voxels_of(row)) : Json(nullptr)},
          {"triangles", or_null(row.triangles)},
          {"program_triangles", or_null(row.program_triangles)},
          {"seconds",
           {{"thesis_program_today", or_null(row.seconds.program)},
            {"one_thread", or_null(row.seconds.one_thread)},
            {"as_it_runs", or_null(row.seconds.all)},
            {"kernels", or_null(row.seconds.kernels)}}},
          {"triangles_ratio", or_null(triangles_ratio(row))},
          {"seconds_ratio", or_null(seconds_ratio(row))},
          {"seconds_per_triangle_ratio", or_null(per_triangle_ratio(row))}};
}

}  // namespace

std::string thesis_bench_text(const ThesisBench& bench) {
  std::string text;
  const Text out(text);
  std::string table;
  for (const ThesisBenchRow& row : bench.rows) {
    if (table != row.table) print_header(out, row.table);
    table = row.table;
    if (row.structure) print_row(out, row);
  }
  print_notes(out, bench);
  return text;
}

std::string thesis_bench_csv(const ThesisBench& bench) {
  std::string csv =
      "table,column,thesis_entry,thesis_atoms,thesis_voxels,thesis_triangles,thesis_seconds,"
      "structure,stand_in,missing,atoms,voxels,triangles,seconds_thesis_program_today,"
      "seconds_one_thread,seconds_as_it_runs,seconds_kernels,triangles_ratio,seconds_ratio,"
      "seconds_per_triangle_ratio\n";
  for (const ThesisBenchRow& row : bench.rows) {
    const bool ran = row.structure.has_value();
    csv += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", row.table, row.column,
        row.entry.id, row.entry.atoms, row.entry.voxels, row.thesis.triangles, row.thesis.seconds,
        ran ? csv_field(row.structure->id) : "", is_stand_in(row), !ran,
        ran ? std::to_string(row.atoms) : "", ran ? std::to_string(voxels_of(row)) : "",
        csv_count(row.triangles), csv_number(row.seconds.program),
        csv_number(row.seconds.one_thread), csv_number(row.seconds.all),
        csv_number(row.seconds.kernels), csv_number(triangles_ratio(row)),
        csv_number(seconds_ratio(row)), csv_number(per_triangle_ratio(row)));
  }
  return csv;
}

std::string thesis_bench_json(const ThesisBench& bench) {
  Json rows = Json::array();
  for (const ThesisBenchRow& row : bench.rows) rows.push_back(row_json(row));
  const bool none = bench.no_device.empty();
  return write_json({{"schema", "vdwmesh-bench-thesis/1"},
                     {"version", kVersion},
                     {"revision", kRevision},
                     {"threads", bench.threads},
                     {"device", or_null(bench.device)},
                     {"driver", or_null(bench.driver)},
                     {"no_device", none ? Json(nullptr) : Json(bench.no_device)},
                     {"rows", rows}});
}

}  // namespace vdwmesh::apps
