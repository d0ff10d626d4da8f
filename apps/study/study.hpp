// A study: the plan of its runs, what it finds, and where finished runs are kept.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/study.hpp"
#include "report/json_text.hpp"
#include "report/report.hpp"
#include "steps/steps.hpp"
#include "study/study_options.hpp"

namespace vdwmesh::apps {

struct StudyInput {
  std::string name;  // unique within the study
  Structure structure;
  SphereSet atoms;   // whose surface is meshed: without the probe, if that is the excluded one
  std::string hash;  // of the spheres, and of the probe of an excluded surface
  InputReport report;
  std::vector<std::string> warnings;  // for people: what may be wrong with the file
  ExactReport exact;                  // area and volume of the surface that the meshes approximate
  std::optional<ExcludedMeasures> excluded;  // if that is the excluded one
  double exact_seconds = 0;
};

struct RefusedRun {
  StudySetting setting;
  std::string reason;
};

struct StudyFindings {
  StudyInput input;
  std::vector<StudyRun> runs;  // by setting
  std::vector<RefusedRun> refused;
  std::vector<StudySeries> series;
};

struct Study {
  StudyOptions options;
  std::vector<BackendReport> backends;  // one per backend that ran
  std::vector<StudyFindings> findings;  // one per input
  std::uint64_t runs_found = 0, runs_made = 0;
  std::uint64_t runs_left = 0;  // not begun within the time limit
  double seconds = 0;
};

// The SurfaceOptions that make_mesh() and make_excluded_mesh() take for a setting.
SurfaceOptions surface_options(const StudySetting& setting, ExactSurface surface);

// Runs with the threads that the caller allows. Reads the inputs and makes every run that the
// folder does not hold yet; each is kept there as soon as it is finished. Throws what the stages
// throw, but for a run that is beyond a limit or too coarse: that is recorded as refused.
Study make_study(const std::vector<InputOptions>& inputs, const StudyOptions& options);

std::string study_csv(const Study& study);
// The document of docs/study.schema.json: indented in the folder, compact in the page.
std::string study_json(const Study& study, JsonText::Layout layout = JsonText::Layout::indented);
// One self-contained page. Meshes are made anew for it; one that is now beyond a limit is left out,
// and `warnings` say so.
std::string study_html(const Study& study, std::vector<std::string>& warnings);

}  // namespace vdwmesh::apps
