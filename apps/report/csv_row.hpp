// A line of a table whose columns are the members of what is described, in their order.
#pragma once

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "command_line/names.hpp"
#include "report/csv.hpp"
#include "report/describe.hpp"

namespace vdwmesh::apps {

// A visitor of described types. Members of members are called "outer_inner", counts by name are
// their sum, and lists have no cell. The columns do not depend on the values: where there is no
// value, its cells, or those of its members, are empty.
class CsvRow {
 public:
  // Columns whose names begin with one of these are left out.
  explicit CsvRow(std::vector<std::string_view> left_out = {}) : left_out_(std::move(left_out)) {}

  template <class T>
  void operator()(const std::string& key, const T& value) {
    write(prefix_ + key, value);
  }

  // Both with commas between the cells, and without a line break.
  const std::string& names() const { return names_; }
  const std::string& values() const { return values_; }

 private:
  void add(const std::string& name, const std::string& text) {
    const auto begins_name = [&](std::string_view left_out) { return name.starts_with(left_out); };
    if (std::any_of(left_out_.begin(), left_out_.end(), begins_name)) return;
    if (!names_.empty()) names_ += ',', values_ += ',';
    names_ += name;
    if (!is_blank_) values_ += csv_field(text);
  }

  void write(const std::string& name, bool value) { add(name, value ? "true" : "false"); }
  void write(const std::string& name, double value) { add(name, csv_number(value)); }
  template <Number T>
  void write(const std::string& name, T value) {
    if constexpr (std::is_floating_point_v<T>)
      write(name, double{value});
    else
      add(name, std::to_string(value));
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
    add(name, std::to_string(std::accumulate(
                  counts.begin(), counts.end(), std::uint64_t{0},
                  [](std::uint64_t sum, const auto& count) { return sum + count.second; })));
  }
  template <class T>
  void write(const std::string&, const std::vector<T>&) {}
  template <class T>
  requires(std::is_class_v<T> && !Textual<T>) void write(const std::string& name, const T& value) {
    const std::string outer = std::exchange(prefix_, name + '_');
    describe(*this, value);
    prefix_ = outer;
  }

  std::vector<std::string_view> left_out_;
  std::string names_, values_, prefix_;
  bool is_blank_ = false;  // within what has no value
};

}  // namespace vdwmesh::apps
