// Prints the rerun tables: laid out for people, and, from one description of a row, as CSV and
// JSON. Seconds of the thesis are compared with ours only where the molecule is the same; stand-ins
// compare by the seconds per triangle.
#include <fmt/format.h>

#include <iterator>
#include <set>

#include "build_id.hpp"
#include "report/csv.hpp"
#include "report/json_text.hpp"
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
                 or_dash(row.triangles, "{}"), or_dash(triangles_ratio(row), "{:.3f}"),
                 row.thesis.seconds, gpu ? "" : or_dash(s.program, "{:.4f}"),
                 gpu ? or_dash(s.kernels, "{:.6f}") : or_dash(s.one_thread, "{:.4f}"),
                 or_dash(s.all, gpu ? "{:.6f}" : "{:.4f}"), or_dash(seconds_ratio(row), "{:.1f}"),
                 or_dash(per_triangle_ratio(row), "{:.1f}"));
}

// What the reader must know to compare: other machines, stand-ins, and what did not run.
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
        fmt::join(stand_ins, ", "));
  }
  if (!missing.empty())
    fmt::format_to(out, "Missing, no structure file: {}.\n", fmt::join(missing, ", "));
}

// What the thesis printed of a row.
struct Printed {
  const ThesisBenchRow& row;
};

}  // namespace

template <class A>
void describe(A& a, const Printed& printed) {
  const ThesisBenchRow& row = printed.row;
  a("entry", row.entry.id), a("atoms", row.entry.atoms), a("voxels", row.entry.voxels);
  a("triangles", row.thesis.triangles), a("seconds", row.thesis.seconds);
}

template <class A>
void describe(A& a, const ThesisTimes& seconds) {
  a("thesis_program_today", seconds.program), a("one_thread", seconds.one_thread);
  a("as_it_runs", seconds.all), a("kernels", seconds.kernels);
}

template <class A>
void describe(A& a, const ThesisBenchRow& row) {
  const bool ran = row.structure.has_value();
  const auto if_ran = [&](const auto& value) { return ran ? std::optional(value) : std::nullopt; };
  a("table", row.table), a("column", row.column);
  a("thesis", Printed{row});
  a("structure", ran ? std::optional(row.structure->id) : std::nullopt);
  a("stand_in", is_stand_in(row)), a("missing", !ran);
  a("atoms", if_ran(row.atoms));
  a("grid", if_ran(std::vector{row.grid.x, row.grid.y, row.grid.z}));
  a("voxels", if_ran(voxels_of(row)));
  a("triangles", row.triangles), a("program_triangles", row.program_triangles);
  a("seconds", row.seconds);
  a("triangles_ratio", triangles_ratio(row)), a("seconds_ratio", seconds_ratio(row));
  a("seconds_per_triangle_ratio", per_triangle_ratio(row));
}

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
  constexpr std::string_view kColumns =
      "table,column,thesis_entry,thesis_atoms,thesis_voxels,thesis_triangles,"
      "thesis_seconds,structure,stand_in,missing,atoms,voxels,triangles,"
      "seconds_thesis_program_today,seconds_one_thread,seconds_as_it_runs,seconds_kernels,"
      "triangles_ratio,seconds_ratio,seconds_per_triangle_ratio";
  std::vector<Cells> rows;
  for (const ThesisBenchRow& row : bench.rows) describe(rows.emplace_back(csv_number), row);
  return csv_table(kColumns, rows);
}

std::string thesis_bench_json(const ThesisBench& bench) {
  const bool none = bench.no_device.empty();
  JsonText json;
  json("schema", "vdwmesh-bench-thesis/1");
  json("version", kVersion), json("revision", kRevision);
  json("threads", bench.threads);
  json("device", bench.device), json("driver", bench.driver);
  json("no_device", none ? std::nullopt : std::optional(bench.no_device));
  json("rows", bench.rows);
  return std::move(json).take();
}

}  // namespace vdwmesh::apps
