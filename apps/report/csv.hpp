// Tables: what is described, as single figures, and comma-separated values (RFC 4180) of them.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "command_line/names.hpp"
#include "report/describe.hpp"

namespace vdwmesh::apps {

// The figures of a table by name: a visitor of described types. Members of members are called
// "outer_inner". Lists have no cell.
class Cells {
 public:
  // How numbers that are not whole are written.
  using Format = std::string (*)(double);
  explicit Cells(Format format) : format_(format) {}

  template <class T>
  void operator()(const std::string& key, const T& value) {
    write(prefix_ + key, value);
  }

  // Empty where there is no such cell, or it has no value.
  std::string operator[](const std::string& name) const {
    const auto cell = cells_.find(name);
    return cell == cells_.end() ? "" : cell->second;
  }

 private:
  void write(const std::string& name, bool value) { cells_[name] = value ? "true" : "false"; }
  void write(const std::string& name, double value) { cells_[name] = format_(value); }
  template <Number T>
  void write(const std::string& name, T value) {
    cells_[name] = std::to_string(value);
  }
  template <Textual T>
  void write(const std::string& name, const T& value) {
    cells_[name] = value;
  }
  template <Named T>
  void write(const std::string& name, T value) {
    cells_[name] = name_of(value);
  }
  template <class T>
  void write(const std::string& name, const std::optional<T>& value) {
    if (value) write(name, *value);
  }
  template <class T>
  void write(const std::string&, const std::vector<T>&) {}
  template <class T>
  requires(std::is_class_v<T> && !Textual<T>) void write(const std::string& name, const T& value) {
    const std::string outer = std::exchange(prefix_, name + '_');
    describe(*this, value);
    prefix_ = outer;
  }

  Format format_;
  std::string prefix_;
  std::map<std::string, std::string> cells_;
};

// In tables for people, where a dash stands for what there is not.
template <class T>
std::string or_dash(const std::optional<T>& value, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value) : "-";
}

// Text with a comma, quote or line break is quoted.
std::string csv_field(std::string_view text);
// The fewest digits that read back the same; nothing where it is not finite.
std::string csv_number(double value);

// A table that was read: a header and rows of as many fields.
class CsvFile {
 public:
  // Throws FileFormatError, naming the file and the line, for a file that cannot be read or is no
  // such table.
  explicit CsvFile(const std::filesystem::path& path);

  bool has_column(std::string_view name) const;
  // The fields of a column. Throws FileFormatError where there is none of this name.
  std::vector<std::string> column(std::string_view name) const;

 private:
  std::string path_;
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
};

// A header and one line per row. `columns` is the header: names of cells with commas between.
std::string csv_table(std::string_view columns, const std::vector<Cells>& rows);

}  // namespace vdwmesh::apps
