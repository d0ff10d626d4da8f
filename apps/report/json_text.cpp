// Brackets, keys and values of JSON text. Doubles are written by std::to_chars, whose digits are
// the fewest that read back the same, which those of nlohmann's library are not always. That
// library escapes the strings, and puts U+FFFD where one is not UTF-8.
#include "report/json_text.hpp"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace vdwmesh::apps {

void JsonText::open(char bracket) {
  text_ += bracket;
  ++depth_;
  first_ = true;
}

// An empty object or list stands on one line.
void JsonText::close(char bracket) {
  --depth_;
  if (!first_) break_line();
  text_ += bracket;
  first_ = false;
}

void JsonText::begin_element() {
  if (!first_) text_ += ',';
  first_ = false;
  break_line();
}

void JsonText::begin_member(std::string_view key) {
  begin_element();
  write(key);
  text_ += layout_ == Layout::compact ? ":" : ": ";
}

void JsonText::break_line() {
  if (layout_ == Layout::compact) return;
  text_ += '\n';
  text_.append(2 * depth_, ' ');
}

void JsonText::write(bool value) { text_ += value ? "true" : "false"; }

void JsonText::write(double value) {
  if (!std::isfinite(value)) {
    text_ += "null";
    return;
  }
  char digits[32];
  text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

void JsonText::write(std::string_view value) {
  using nlohmann::json;
  text_ += json(value).dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string JsonText::take() && {
  close('}');
  if (layout_ == Layout::indented) text_ += '\n';
  return std::move(text_);
}

}  // namespace vdwmesh::apps
