// The stages as text, CSV and JSON.
#include <fmt/format.h>

#include <iterator>

#include "build_id.hpp"
#include "csv.hpp"
#include "json_writer.hpp"
#include "pipeline/pipeline_bench.hpp"
#include "printable.hpp"

namespace vdwmesh::apps {
namespace {

using Text = std::back_insert_iterator<std::string>;

constexpr double kMegabyte = 1e6;

std::string_view kind_name(StageKind kind) {
  switch (kind) {
    case StageKind::stage:
      return "stage";
    case StageKind::part:
      return "part";
    default:
      return "beside";
  }
}

std::string or_dash(const std::optional<double>& value, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value) : "-";
}

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

void print_machine(Text out, const PipelineBench& bench) {
  fmt::format_to(out, "Backend: {}, {} threads", backend_name(bench.backend.used),
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

Json stage_json(const StageRow& row) {
  return {{"name", row.name},
          {"kind", kind_name(row.kind)},
          {"cpu_seconds", or_null(row.cpu_seconds)},
          {"wall_seconds", row.wall_seconds},
          {"bytes_read", or_null(row.bytes_read)},
          {"bytes_written", or_null(row.bytes_written)},
          {"peak_memory", or_null(row.peak_memory)},
          {"floor_seconds", or_null(row.floor_seconds)},
          {"floor_ratio", or_null(floor_ratio(row))}};
}

Json case_json(const PipelineCase& done) {
  Json stages = Json::array();
  for (const StageRow& row : done.stages) stages.push_back(stage_json(row));
  return {{"input", done.input},       {"warnings", done.warnings},
          {"spacing", done.spacing},   {"spheres", done.spheres},
          {"vertices", done.vertices}, {"triangles", done.triangles},
          {"stages", stages},          {"total", stage_json(total_of(done))}};
}

}  // namespace

std::string pipeline_bench_text(const PipelineBench& bench) {
  std::string text;
  const Text out(text);
  print_machine(out, bench);
  for (const PipelineCase& done : bench.cases) print_case(out, done);
  return text;
}

std::string pipeline_bench_csv(const PipelineBench& bench) {
  std::string csv =
      "input,spacing,spheres,vertices,triangles,stage,kind,cpu_seconds,wall_seconds,bytes_read,"
      "bytes_written,peak_memory,floor_seconds,floor_ratio\n";
  for (const PipelineCase& done : bench.cases) {
    for (const StageRow& row : done.stages) {
      csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(done.input),
                         done.spacing, done.spheres, done.vertices, done.triangles,
                         csv_field(row.name), kind_name(row.kind), csv_number(row.cpu_seconds),
                         csv_number(row.wall_seconds), csv_count(row.bytes_read),
                         csv_count(row.bytes_written), csv_count(row.peak_memory),
                         csv_number(row.floor_seconds), csv_number(floor_ratio(row)));
    }
  }
  return csv;
}

std::string pipeline_bench_json(const PipelineBench& bench) {
  Json cases = Json::array();
  for (const PipelineCase& done : bench.cases) cases.push_back(case_json(done));
  return write_json(
      {{"schema", "vdwmesh-bench-pipeline/1"},
       {"version", kVersion},
       {"revision", kRevision},
       {"backend",
        {{"requested", backend_name(bench.backend.requested)},
         {"used", backend_name(bench.backend.used)},
         {"device", or_null(bench.backend.device)},
         {"driver", or_null(bench.backend.driver)},
         {"threads", bench.backend.threads}}},
       {"copy_bytes_per_second", {{"warm", bench.copy.warm}, {"fresh", bench.copy.fresh}}},
       {"cases", cases}});
}

}  // namespace vdwmesh::apps
