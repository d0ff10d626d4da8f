#include "json_writer.hpp"

#include <charconv>
#include <cmath>

namespace vdwmesh::apps {
namespace {

constexpr std::size_t kIndent = 2;

void write(const Json& value, std::size_t indent, std::string& out);

void write_line_break(std::size_t indent, std::string& out) {
  out += '\n';
  out.append(indent, ' ');
}

void write_string(const std::string& text, std::string& out) {
  out += Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

// nlohmann::json's own digits are not always the shortest; those of std::to_chars are.
void write_double(double value, std::string& out) {
  if (!std::isfinite(value)) {
    out += "null";
    return;
  }
  char digits[32];
  const std::to_chars_result end = std::to_chars(digits, digits + sizeof digits, value);
  out.append(digits, end.ptr);
}

void write_object(const Json& value, std::size_t indent, std::string& out) {
  const char* separator = "";
  out += '{';
  for (const auto& [key, member] : value.items()) {
    out += separator;
    separator = ",";
    write_line_break(indent + kIndent, out);
    write_string(key, out);
    out += ": ";
    write(member, indent + kIndent, out);
  }
  if (!value.empty()) write_line_break(indent, out);
  out += '}';
}

bool holds_numbers_only(const Json& array) {
  for (const Json& element : array) {
    if (!element.is_number()) return false;
  }
  return true;
}

void write_array(const Json& value, std::size_t indent, std::string& out) {
  const bool one_line = holds_numbers_only(value);
  const char* separator = "";
  out += '[';
  for (const Json& element : value) {
    out += separator;
    separator = one_line ? ", " : ",";
    if (!one_line) write_line_break(indent + kIndent, out);
    write(element, indent + kIndent, out);
  }
  if (!one_line) write_line_break(indent, out);
  out += ']';
}

void write(const Json& value, std::size_t indent, std::string& out) {
  if (value.is_object()) return write_object(value, indent, out);
  if (value.is_array()) return write_array(value, indent, out);
  if (value.is_string()) return write_string(value.get_ref<const std::string&>(), out);
  if (value.is_number_float()) return write_double(value.get<double>(), out);
  out += value.dump();
}

}  // namespace

std::string write_json(const Json& value) {
  std::string out;
  write(value, 0, out);
  out += '\n';
  return out;
}

}  // namespace vdwmesh::apps
