// A hand-written scanner: the first character of a token decides what it is, and the loops that
// look for its end visit each character once. next(), in the header, reads words.
#include "structure/cif/cif_tokens.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "core/read_double.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

bool is_blank(char c) { return cif_byte(c) == CifByte::blank; }

bool begins_with(std::string_view word, std::string_view start) {  // `start` in lower case
  return word.size() >= start.size() &&
         std::equal(start.begin(), start.end(), word.begin(),
                    [](char a, char b) { return a == lower_case(b); });
}

bool is_reserved(std::string_view word) {
  return (word.size() == 5 && begins_with(word, "stop_")) ||
         (word.size() == 7 && begins_with(word, "global_"));
}

}  // namespace

void CifTokens::skip_blanks() {
  while (at_ < text_.size()) {
    if (is_blank(text_[at_])) {
      ++at_;
    } else if (text_[at_] == '#') {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else {
      return;
    }
  }
}

// Moves behind `length` characters from the start of the token, and returns them.
std::string_view CifTokens::take(std::size_t length) {
  at_ = start_ + length;
  return text_.substr(start_, length);
}

CifToken CifTokens::text_field() {
  const std::size_t end = text_.find("\n;", start_);
  if (end == text_.npos) fail("a text field without end (a semicolon that begins a line)");
  return {CifKind::value, take(end + 2 - start_)};
}

CifToken CifTokens::quoted() {
  const char quote = text_[start_];
  for (std::size_t i = start_ + 1; i < text_.size() && text_[i] != '\n'; ++i)
    if (text_[i] == quote && (i + 1 == text_.size() || is_blank(text_[i + 1])))
      return {CifKind::value, take(i + 1 - start_)};
  fail("a quote without end");
}

// What an unquoted token is. Only the first letters of keywords need a closer look.
CifKind CifTokens::kind_of(std::string_view word) const {
  const char first = lower_case(word.front());
  if (first == '_') return CifKind::tag;
  if (first == 'd' && begins_with(word, "data_")) return CifKind::data;
  if (first == 'l' && word.size() == 5 && begins_with(word, "loop_")) return CifKind::loop;
  if (first == 's' && begins_with(word, "save_")) return CifKind::save;
  if ((first == 's' || first == 'g') && is_reserved(word))
    fail(fmt::format("the reserved word {}", word));
  return CifKind::value;
}

CifToken CifTokens::word() {
  std::size_t end = start_;
  while (end < text_.size() && !is_blank(text_[end])) ++end;
  const std::string_view text = take(end - start_);
  return {kind_of(text), text};
}

CifToken CifTokens::next_special() {
  skip_blanks();
  start_ = at_;
  if (at_ == text_.size()) return {};
  const char c = text_[at_];
  if (c == '\'' || c == '"') return quoted();
  if (c == ';' && (at_ == 0 || text_[at_ - 1] == '\n')) return text_field();
  return word();
}

void CifTokens::fail(const std::string& what) const {
  const auto line =
      1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(start_), '\n');
  throw FileFormatError(fmt::format("{}:{}: {}", path_, line, what));
}

std::string_view cif_text(std::string_view value) {
  if (value == "?" || value == ".") return {};
  if (value.size() >= 2 && (value.front() == '\'' || value.front() == '"'))
    return value.substr(1, value.size() - 2);
  if (value.size() > 2 && value.front() == ';' && value.ends_with("\n;")) {
    value = value.substr(1, value.size() - 3);
    if (value.ends_with('\r')) value.remove_suffix(1);
  }
  return value;
}

double cif_number(std::string_view value) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (value.starts_with('+') && !value.starts_with("+-")) value.remove_prefix(1);
  if (const std::optional<double> number = short_decimal(value)) return *number;
  // read_double reads "inf" and "nan", too, which CIF does not know.
  const std::size_t first = value.starts_with('-') ? 1 : 0;
  if (first == value.size() || (!is_digit(value[first]) && value[first] != '.')) return kNone;
  double number = 0;
  const char* const last = value.data() + value.size();
  const auto [end, error] = read_double(value.data(), last, number);
  if (error != std::errc()) return kNone;
  if (end == last) return number;
  const bool uncertain =
      *end == '(' && value.back() == ')' && std::all_of(end + 1, last - 1, is_digit);
  return uncertain ? number : kNone;
}

}  // namespace vdwmesh
