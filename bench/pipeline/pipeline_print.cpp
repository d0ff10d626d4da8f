// Prints the stages: as tables for people, and, from one description of a stage, as CSV and JSON.
// Parts of a stage are indented below it; work beside the way from file to file is in brackets, and
// no part of the total.
#include <fmt/format.h>

#include <iterator>

#include "build_id.hpp"
#include "pipeline/pipeline_bench.hpp"
#include "report/csv.hpp"
#include "report/json_text.hpp"
#include "report/printable.hpp"

namespace vdwmesh::apps {
namespace {

using Text = std::back_insert_iterator<std::string>;

constexpr double kMegabyte = 1e6;

std::string megabytes(const std::optional<std::uint64_t>& bytes) {
  return bytes ? fmt::format("{:.1f}", static_cast<double>(*bytes) / kMegabyte) : "-";
}

std::string label_of(const StageRow& row) {
  if (row.kind == StageKind::part) return "  " + row.name;
  return row.kind == StageKind::beside ? "(" + row.name + ")" : row.name;
}

void print_stage(Text out, const StageRow& row) {
  fmt::format_to(out, "{:<22} {:>9} {:>9.4f} {:>9} {:>9} {:>8} {:>9} {:>7}\n", label_of(row),
                 or_dash(row.cpu_seconds, "{:.4f}"), row.wall_seconds, megabytes(row.bytes_read),
                 megabytes(row.bytes_written), megabytes(row.peak_memory),
                 or_dash(row.floor_seconds, "{:.4f}"), or_dash(floor_ratio(row), "{:.1f}"));
}

void print_case(Text out, const PipelineCase& done) {
  fmt::format_to(out, "\n{} at {} Å: {} spheres, {} vertices, {} triangles\n",
                 printable(done.input), done.spacing, done.spheres, done.vertices, done.triangles);
  fmt::format_to(out, "{:<22} {:>9} {:>9} {:>9} {:>9} {:>8} {:>9} {:>7}\n", "stage", "CPU s",
                 "wall s", "read MB", "write MB", "peak MB", "floor s", "CPU / f");
  for (const StageRow& row : done.stages) print_stage(out, row);
  print_stage(out, total_of(done));
}

// Figures of a benchmark mean nothing without the machine that they are of.
void print_machine(Text out, const PipelineBench& bench) {
  fmt::format_to(out, "Backend: {}, {} threads", name_of(bench.backend.used),
                 bench.backend.threads);
  if (bench.backend.device)
    fmt::format_to(out, ", {}, driver {}", *bench.backend.device,
                   bench.backend.driver.value_or("unknown"));
  fmt::format_to(out,
                 ".\nCopy on one core: {:.1f} GB/s, read and written both counted; {:.1f} GB/s "
                 "into fresh pages.\n"
                 "Floor: the bytes that must be read and written once, at the first of these "
                 "rates. In brackets: work beside the way from file to file.\n",
                 bench.copy.warm / 1e9, bench.copy.fresh / 1e9);
}

}  // namespace

template <class A>
void describe(A& a, const StageRow& row) {
  a("name", row.name), a("kind", row.kind);
  a("cpu_seconds", row.cpu_seconds), a("wall_seconds", row.wall_seconds);
  a("bytes_read", row.bytes_read), a("bytes_written", row.bytes_written);
  a("peak_memory", row.peak_memory);
  a("floor_seconds", row.floor_seconds), a("floor_ratio", floor_ratio(row));
}

template <class A>
void describe(A& a, const PipelineCase& done) {
  a("input", done.input), a("warnings", done.warnings);
  a("spacing", done.spacing), a("spheres", done.spheres);
  a("vertices", done.vertices), a("triangles", done.triangles);
  a("stages", done.stages), a("total", total_of(done));
}

template <class A>
void describe(A& a, const CopyRate& rate) {
  a("warm", rate.warm), a("fresh", rate.fresh);
}

std::string pipeline_bench_text(const PipelineBench& bench) {
  std::string text;
  const Text out(text);
  print_machine(out, bench);
  for (const PipelineCase& done : bench.cases) print_case(out, done);
  return text;
}

std::string pipeline_bench_csv(const PipelineBench& bench) {
  constexpr std::string_view kColumns =
      "input,spacing,spheres,vertices,triangles,stage,kind,cpu_seconds,wall_seconds,"
      "bytes_read,bytes_written,peak_memory,floor_seconds,floor_ratio";
  std::vector<Cells> rows;
  for (const PipelineCase& done : bench.cases) {
    for (const StageRow& stage : done.stages) {
      // Both descriptions go into one row. The column "stage" is the member "name" of the stage.
      Cells& row = rows.emplace_back(csv_number);
      describe(row, done), describe(row, stage), row("stage", stage.name);
    }
  }
  return csv_table(kColumns, rows);
}

std::string pipeline_bench_json(const PipelineBench& bench) {
  const BackendReport& backend = bench.backend;
  JsonText json;
  json("schema", "vdwmesh-bench-pipeline/1");
  json("version", kVersion), json("revision", kRevision);
  json.object("backend", [&] {
    json("requested", backend.requested), json("used", backend.used);
    json("device", backend.device), json("driver", backend.driver);
    json("threads", backend.threads);
  });
  json("copy_bytes_per_second", bench.copy);
  json("cases", bench.cases);
  return std::move(json).take();
}

}  // namespace vdwmesh::apps
