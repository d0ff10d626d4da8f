// Fields as RFC 4180 quotes them, numbers as short as they may be, and tables of cells. A header is
// a list of names of cells, so that the columns of a table and their order are one line of text,
// and header and rows cannot differ.
#include "csv.hpp"

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

// Cells that a row does not have stay empty, as a figure does that was not computed.
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
