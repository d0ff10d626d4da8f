// Fields as RFC 4180 quotes them, numbers as short as they may be, and tables of cells.
#include "csv.hpp"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

namespace vdwmesh::apps {

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\n\r") == text.npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : std::string();
}

std::string csv_table(std::string_view columns, const std::vector<Cells>& rows) {
  std::string csv = std::string(columns) + '\n';
  for (const Cells& row : rows) {
    std::istringstream names{std::string(columns)};
    for (std::string name; std::getline(names, name, ',');) csv += csv_field(row[name]) + ',';
    csv.back() = '\n';
  }
  return csv;
}

}  // namespace vdwmesh::apps
