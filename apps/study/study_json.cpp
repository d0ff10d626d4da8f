#include "study/study_json.hpp"

#include "build_id.hpp"
#include "extract/extractor.hpp"
#include "report_json.hpp"
#include "study/records.hpp"

namespace vdwmesh::apps {
namespace {

constexpr const char* kSchema = "vdwmesh-study/1";

template <class T, class Convert>
Json list(const std::vector<T>& values, Convert&& convert) {
  Json result = Json::array();
  for (const T& value : values) result.push_back(convert(value));
  return result;
}

Json parameters_json(const StudyOptions& options) {
  const StudyAxes& axes = options.axes;
  const bool distances = options.distances.distances == Switch::on;
  return {{"meshers", list(axes.meshers, mesher_name)},
          {"spacings", axes.spacings},
          {"edge_lengths", axes.edge_lengths},
          {"subdivisions", axes.subdivisions},
          {"fields", list(axes.fields, field_name)},
          {"projections", list(axes.projections, study_projection_name)},
          {"samples", distances ? Json(options.distances.samples_per_area) : Json(nullptr)},
          {"seed", distances ? Json(options.distances.seed) : Json(nullptr)},
          {"memory_limit", options.machine.memory_limit == kNoMemoryLimit
                               ? Json(nullptr)
                               : Json(options.machine.memory_limit)}};
}

Json refused_json(const RefusedRun& refused) {
  return {{"parameters", setting_json(refused.setting)}, {"reason", refused.reason}};
}

Json relative_error(const std::optional<Extrapolation>& found, double exact) {
  return found ? Json((found->limit - exact) / exact) : Json(nullptr);
}

Json compared_series(const StudySeries& series, const ExactUnion& exact) {
  Json json = series_json(series);
  json["area_extrapolated_relative_error"] = relative_error(series.area, exact.area);
  json["volume_extrapolated_relative_error"] = relative_error(series.volume, exact.volume);
  return json;
}

Json findings_json(const StudyFindings& f) {
  return {{"name", f.input.name},
          {"input", input_json(f.input.report)},
          {"warnings", f.input.warnings},
          {"exact", exact_json(f.input.exact)},
          {"exact_seconds", f.input.exact_seconds},
          {"runs", list(f.runs, run_json)},
          {"refused", list(f.refused, refused_json)},
          {"series", list(f.series, [&](const StudySeries& series) {
             return compared_series(series, f.input.exact);
           })}};
}

}  // namespace

Json study_document(const Study& study) {
  return {{"schema", kSchema},
          {"version", kVersion},
          {"revision", kRevision},
          {"parameters", parameters_json(study.options)},
          {"backends", list(study.backends, backend_json)},
          {"runs_found", study.runs_found},
          {"runs_made", study.runs_made},
          {"runs_left", study.runs_left},
          {"seconds", study.seconds},
          {"inputs", list(study.findings, findings_json)}};
}

std::string study_json(const Study& study) { return write_json(study_document(study)); }

}  // namespace vdwmesh::apps
