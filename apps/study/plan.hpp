// Which calls of the pipeline a study takes.
#pragma once

#include <span>
#include <vector>

#include "analysis/study.hpp"
#include "cuda/backend_choice.hpp"
#include "study/study_options.hpp"

namespace vdwmesh::apps {

// One call, which can give the meshes of all levels up to its deepest.
struct StudyTask {
  std::size_t input;
  StudySetting setting;     // of the deepest level
  std::vector<int> levels;  // wanted, rising
  double weight;            // about proportional to the time it takes
};

// The setting of another level of the same refinement. Projection follows a subdivision, so that
// level 0 is the same for all of them.
StudySetting at_level(StudySetting setting, int level);

// By the triangles of the mesh, of which those projected to a field take longer.
double study_weight(double exact_area, const StudySetting& setting);

// Every setting once. `exact_areas` has one entry per input.
std::vector<StudyTask> plan_study(const StudyAxes& axes, std::span<const Backend> backends,
                                  std::span<const double> exact_areas);

}  // namespace vdwmesh::apps
