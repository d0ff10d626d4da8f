// The document that docs/study.schema.json describes: what was asked for, and per input its runs,
// what was refused, and the series with the limits that they tend to. The page of the study carries
// the same document without blanks.
#include <utility>

#include "build_id.hpp"
#include "report/describe_report.hpp"
#include "study/describe_study.hpp"
#include "study/study.hpp"

namespace vdwmesh::apps {
namespace {

std::optional<double> relative_error(const std::optional<Extrapolation>& found, double exact) {
  return found ? std::optional((found->limit - exact) / exact) : std::nullopt;
}

}  // namespace

// The axes as they were planned, and what was sampled, where anything was.
void describe(JsonText& a, const StudyOptions& options) {
  const StudyAxes& axes = options.axes;
  const DistanceChoice& d = options.distances;
  const bool distances = d.distances == Switch::on;
  a("surface", options.surface);
  a("meshers", axes.meshers);
  a("spacings", axes.spacings), a("edge_lengths", axes.edge_lengths);
  a("subdivisions", axes.subdivisions);
  a("fields", axes.fields);
  a("projections", axes.projections);
  a("samples", distances ? std::optional(d.samples_per_area) : std::nullopt);
  a("seed", distances ? std::optional(d.seed) : std::nullopt);
  a("memory_limit", limit_of(options.machine.memory_limit));
}

void describe(JsonText& a, const RefusedRun& refused) {
  a("parameters", refused.setting), a("reason", refused.reason);
}

// A series is compared with the exact measures of its input, which the series itself does not know.
void describe(JsonText& a, const StudyFindings& f) {
  const ExactReport& exact = f.input.exact;
  a("name", f.input.name);
  a("input", f.input.report);
  a("warnings", f.input.warnings);
  a("exact", exact), a("excluded", f.input.excluded), a("exact_seconds", f.input.exact_seconds);
  a("runs", f.runs), a("refused", f.refused);
  a.list("series", f.series, [&](const StudySeries& series) {
    describe(a, series);
    a("area_extrapolated_relative_error", relative_error(series.area, exact.area));
    a("volume_extrapolated_relative_error", relative_error(series.volume, exact.volume));
  });
}

std::string study_json(const Study& study, JsonText::Layout layout) {
  JsonText json(layout);
  json("schema", "vdwmesh-study/1");
  json("version", kVersion), json("revision", kRevision);
  json("parameters", study.options);
  json("backends", study.backends);
  json("runs_found", study.runs_found), json("runs_made", study.runs_made);
  json("runs_left", study.runs_left);
  json("seconds", study.seconds);
  json("inputs", study.findings);
  return std::move(json).take();
}

}  // namespace vdwmesh::apps
