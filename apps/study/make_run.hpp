// The runs of one task of a study.
#pragma once

#include <vector>

#include "study/plan.hpp"
#include "study/study.hpp"

namespace vdwmesh::apps {

// Meshes of all levels of the task, measured; throws what the stages throw.
std::vector<StudyRun> make_runs(const StudyTask& task, const StudyInput& input,
                                const StudyOptions& options, Monitor* monitor);

}  // namespace vdwmesh::apps
