// Tables: what is described, as single figures, and comma-separated values (RFC 4180) of them.
#pragma once

#include <fmt/format.h>

#include <cstdint>
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

// The figures of a table by name, in order: a visitor of described types. Members of members are
// called "outer_inner", counts by name are their sum, and lists have no cell. The names do not
// depend on the values: where there is no value, its cells, or those of its members, are empty.
class Cells {
 public:
  // How numbers that are not whole are written.
  using Format = std::string (*)(double);
  // Cells whose names begin with one of `left_out` are left out.
  explicit Cells(Format format, std::vector<std::string_view> left_out = {})
      : format_(format), left_out_(std::move(left_out)) {}

  template <class T>
  void operator()(const std::string& key, const T& value) {
    write(prefix_ + key, value);
  }

  // The last cell of this name; empty where there is none, or it has no value.
  std::string operator[](std::string_view name) const;
  // All of them with commas between, without a line break.
  std::string names() const;
  std::string values() const;

 private:
  void add(const std::string& name, std::string text);
  void write(const std::string& name, bool value) { add(name, value ? "true" : "false"); }
  template <Number T>
  void write(const std::string& name, T value) {
    if constexpr (std::is_floating_point_v<T>) {
      add(name, format_(double{value}));
    } else {
      add(name, std::to_string(value));
    }
  }
  template <Textual T>
  void write(const std::string& name, const T& value) {
    add(name, std::string(value));
  }
  template <Named T>
  void write(const std::string& name, T value) {
    add(name, std::string(name_of(value)));
  }
  template <class T>
  void write(const std::string& name, const std::optional<T>& value) {
    if (value) return write(name, *value);
    const bool was_blank = std::exchange(is_blank_, true);
    write(name, T{});
    is_blank_ = was_blank;
  }
  void write(const std::string& name, const std::map<std::string, std::uint64_t>& counts) {
    std::uint64_t sum = 0;
    for (const auto& [key, count] : counts) sum += count;
    write(name, sum);
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
  std::vector<std::string_view> left_out_;
  std::string prefix_;
  std::vector<std::pair<std::string, std::string>> cells_;
  bool is_blank_ = false;  // within what has no value
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
