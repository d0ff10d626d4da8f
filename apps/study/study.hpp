// A study: the plan of its runs, what it finds, and where finished runs are kept.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/study.hpp"
#include "cuda/backend.hpp"
#include "options.hpp"
#include "report.hpp"
#include "spheres/sphere_set.hpp"
#include "steps.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh::apps {

// What vertices are moved to after a subdivision, told per field.
enum class StudyProjection { own, vdw, field, none };

struct StudyAxes {
  std::vector<Mesher> meshers = {Mesher::marching_cubes};
  std::vector<double> spacings = {1, 0.5, 0.25};   // Å, of marching cubes
  std::vector<double> edge_lengths = {0.7, 0.35};  // Å, of the exact mesher
  std::vector<int> subdivisions = {0, 1};
  std::vector<FieldKind> fields = {FieldKind::vdw, FieldKind::blinn, FieldKind::soft_object,
                                   FieldKind::inverse_squared};
  std::vector<StudyProjection> projections = {StudyProjection::own, StudyProjection::vdw};
  std::vector<Backend> backends = {Backend::automatic};
};

std::string_view study_projection_name(StudyProjection projection);

enum class Resume { on, off };

struct StudyOptions {
  StudyAxes axes;
  DistanceChoice distances;
  SelfIntersections self_intersections = SelfIntersections::small_meshes;
  MachineOptions machine;
  std::filesystem::path folder;
  Resume resume = Resume::on;
  std::optional<double> time_limit;          // s after which no further run begins
  std::uint64_t page_triangles = 1'000'000;  // of all meshes that the page shows
};

struct StudyInput {
  std::string name;  // unique within the study
  Molecule molecule;
  SphereSet spheres;
  std::string hash;  // of the spheres
  InputReport report;
  std::vector<std::string> warnings;  // for people: what may be wrong with the file
  ExactUnion exact;
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

// The SurfaceOptions that make_mesh() takes for a setting.
SurfaceOptions surface_options(const StudySetting& setting);

// Runs with the threads that the caller allows. Reads the inputs and makes every run that the
// folder does not hold yet; each is kept there as soon as it is finished. Throws what the stages
// throw, but for a run that is beyond a limit or too coarse: that is recorded as refused.
Study make_study(const std::vector<InputOptions>& inputs, const StudyOptions& options);

std::string study_csv(const Study& study);
std::string study_json(const Study& study);
// One self-contained page. Meshes are made anew for it; one that is now beyond a limit is left out,
// and `warnings` say so.
std::string study_html(const Study& study, std::vector<std::string>& warnings);

}  // namespace vdwmesh::apps
