// Blocks of the report's JSON that other documents have as well.
#pragma once

#include "json_writer.hpp"
#include "report.hpp"

namespace vdwmesh::apps {

Json input_json(const InputReport& input);
Json backend_json(const BackendReport& backend);
Json exact_json(const ExactUnion& exact);

}  // namespace vdwmesh::apps
