// Records of a study as JSON, and back: finished runs are kept as they will be printed.
#pragma once

#include "analysis/study.hpp"
#include "json_writer.hpp"

namespace vdwmesh::apps {

Json setting_json(const StudySetting& setting);
Json run_json(const StudyRun& run);
Json series_json(const StudySeries& series);

// The inverse of run_json(). Throws nlohmann::json::exception for anything else.
StudyRun run_from_json(const Json& json);

}  // namespace vdwmesh::apps
