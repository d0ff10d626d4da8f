// JSON text in which every number reads back the same from the fewest digits, and none is NaN or
// infinite.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace vdwmesh::apps {

// Keeps the order in which keys are added.
using Json = nlohmann::ordered_json;

// Two spaces of indentation per level; a number that is not finite becomes null.
std::string write_json(const Json& value);

// null where there is no value.
template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

}  // namespace vdwmesh::apps
