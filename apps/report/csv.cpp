// Reads and writes CSV. Fields are quoted as in RFC 4180; numbers are the shortest that read back
// the same. The header line of a table also chooses the cells of each row, by their names and in
// their order, so header and rows always agree.
#include "report/csv.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

#include "core/errors.hpp"

namespace vdwmesh::apps {
namespace {

// Takes the fields of one row off the text. A quoted field may hold line breaks; `line` counts
// them.
std::vector<std::string> take_row(std::string_view& text, std::size_t& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  std::size_t at = 0;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '\n') ++line;
    if (quoted && c == '"' && at + 1 < text.size() && text[at + 1] == '"') {
      fields.back() += text[++at];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c == '\n' && !quoted) {
      ++at;
      break;
    } else if (c != '\r' || quoted) {
      fields.back() += c;
    }
  }
  text.remove_prefix(at);
  return fields;
}

}  // namespace

CsvFile::CsvFile(const std::filesystem::path& path) : path_(path.string()) {
  std::ifstream file(path, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  if (!file.is_open() || file.bad()) throw FileFormatError(path_ + ": cannot be read");
  std::string_view left = text;
  std::size_t line = 1;
  header_ = take_row(left, line);
  while (!left.empty()) {
    const std::size_t first = line;
    std::vector<std::string> row = take_row(left, line);
    if (row == std::vector<std::string>{""}) continue;
    if (row.size() != header_.size()) {
      throw FileFormatError(fmt::format("{}: line {}: has {} fields, the header {}", path_, first,
                                        row.size(), header_.size()));
    }
    rows_.push_back(std::move(row));
  }
}

bool CsvFile::has_column(std::string_view name) const {
  return std::ranges::find(header_, name) != header_.end();
}

std::vector<std::string> CsvFile::column(std::string_view name) const {
  const auto found = std::ranges::find(header_, name);
  if (found == header_.end()) {
    throw FileFormatError(fmt::format("{}: line 1: has no column {}", path_, name));
  }
  const auto index = static_cast<std::size_t>(found - header_.begin());
  std::vector<std::string> fields;
  for (const std::vector<std::string>& row : rows_) fields.push_back(row[index]);
  return fields;
}

std::string Cells::operator[](std::string_view name) const {
  const auto cell = std::find_if(cells_.rbegin(), cells_.rend(),
                                 [&](const auto& one) { return one.first == name; });
  return cell == cells_.rend() ? "" : cell->second;
}

std::string Cells::names() const {
  std::string line;
  for (const auto& [name, text] : cells_) line += (line.empty() ? "" : ",") + name;
  return line;
}

std::string Cells::values() const {
  std::string line;
  for (const auto& [name, text] : cells_) line += csv_field(text) + ',';
  return line.substr(0, line.empty() ? 0 : line.size() - 1);
}

void Cells::add(const std::string& name, std::string text) {
  const auto begins_name = [&](std::string_view left_out) { return name.starts_with(left_out); };
  if (std::ranges::any_of(left_out_, begins_name)) return;
  cells_.emplace_back(name, is_blank_ ? std::string() : std::move(text));
}

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

// `columns` is the first line of the table; its names choose the cells of each row. A cell is empty
// if the row has none of that name, for example because the figure was not computed.
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
