// JSON text, written member by member. Every number reads back the same from the fewest digits, and
// none is NaN or infinite.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "command_line/names.hpp"
#include "report/describe.hpp"

namespace vdwmesh::apps {

// An object that takes its members in order: a visitor of described types. What has no value, or
// is not finite, becomes null.
class JsonText {
 public:
  // Two spaces for each level, and lists of numbers on one line; or no blanks at all.
  enum class Layout { indented, compact };
  explicit JsonText(Layout layout = Layout::indented) : layout_(layout) { open('{'); }

  template <class T>
  void operator()(std::string_view key, const T& value) {
    begin_member(key);
    write(value);
  }

  // A member that is an object, which `members` writes.
  template <class Members>
  void object(std::string_view key, Members&& members) {
    begin_member(key);
    write_object(members);
  }

  // A member that is a list of objects: `members` writes those of one value.
  template <class T, class Members>
  void list(std::string_view key, const std::vector<T>& values, Members&& members) {
    begin_member(key);
    open('[');
    for (const T& value : values) {
      begin_element();
      write_object([&] { members(value); });
    }
    close(']');
  }

  std::string take() &&;

 private:
  void open(char bracket);
  void close(char bracket);
  void begin_element();
  void begin_member(std::string_view key);
  void break_line();
  void write(bool value);
  void write(double value);
  void write(std::string_view value);

  template <Number T>
  void write(T value) {
    if constexpr (std::is_floating_point_v<T>) return write(double{value});
    text_ += std::to_string(value);
  }
  void write(const char* value) { write(std::string_view(value)); }
  void write(const std::string& value) { write(std::string_view(value)); }

  template <Named T>
  void write(T value) {
    write(name_of(value));
  }

  template <class T>
  void write(const std::optional<T>& value) {
    if (value) return write(*value);
    text_ += "null";
  }

  template <class Members>
  void write_object(Members&& members) {
    open('{');
    members();
    close('}');
  }

  template <class T>
  requires std::is_class_v<T>
  void write(const T& value) {
    write_object([&] { describe(*this, value); });
  }

  template <class T>
  void write(const std::map<std::string, T>& values) {
    write_object([&] {
      for (const auto& [key, value] : values) (*this)(key, value);
    });
  }

  template <class T>
  void write(const std::vector<T>& values) {
    if (Number<T> || values.empty()) return write_row(values);
    open('[');
    for (const T& value : values) {
      begin_element();
      write(value);
    }
    close(']');
  }

  // Numbers on one line.
  void write_row(const auto& values) {
    std::string_view separator;
    text_ += '[';
    for (const auto& value : values) {
      text_ += separator;
      separator = layout_ == Layout::compact ? "," : ", ";
      write(value);
    }
    text_ += ']';
  }

  Layout layout_;
  std::string text_;
  std::size_t depth_ = 0;
  bool first_ = true;  // of its object or list
};

// A described value alone.
template <class T>
std::string json_of(const T& value, JsonText::Layout layout = JsonText::Layout::indented) {
  JsonText json(layout);
  describe(json, value);
  return std::move(json).take();
}

}  // namespace vdwmesh::apps
