// Blocks of the report's JSON that other documents have as well.
#pragma once

#include "json_text.hpp"
#include "report.hpp"

namespace vdwmesh::apps {

void describe(JsonText& a, const InputReport& input);
void describe(JsonText& a, const BackendReport& backend);

// null where memory is not limited.
std::optional<std::uint64_t> limit_or_null(std::uint64_t memory_limit);

}  // namespace vdwmesh::apps
