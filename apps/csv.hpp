// Comma-separated values (RFC 4180).
#pragma once

#include <optional>
#include <string>

namespace vdwmesh::apps {

// Text with a comma, quote or line break is quoted.
std::string csv_field(const std::string& text);

// The fewest digits that read back the same; nothing where there is no value or it is not finite.
std::string csv_number(double value);
std::string csv_number(const std::optional<double>& value);
template <class T>
std::string csv_count(const std::optional<T>& value) {
  return value ? std::to_string(*value) : std::string();
}

}  // namespace vdwmesh::apps
