// The runs of one task of a study.
#pragma once

#include <vector>

#include "study/plan.hpp"
#include "study/study.hpp"

namespace vdwmesh::apps {

// The mesh of the input's surface. The observer may be empty.
IndexedMesh make_study_mesh(const StudyInput& input, const SurfaceOptions& surface,
                            Session& session, const LevelObserver& observer = {});

// Meshes of all levels of the task, measured; throws what the stages throw.
std::vector<StudyRun> make_runs(const StudyTask& task, const StudyInput& input,
                                const StudyOptions& options, Monitor* monitor);

}  // namespace vdwmesh::apps
