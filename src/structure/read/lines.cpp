// Splits the text of structure files into lines and fields, and reads their numbers. No number
// depends on the locale or needs a copy of its field: short_decimal() reads the short decimals of
// most files, read_double() all others, and std::from_chars the integers.
#include "structure/read/lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "core/read_double.hpp"

namespace vdwmesh {
namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";
// The same characters: the codes of all but the blank itself follow each other.
bool is_white_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

// The index of the first LF or CR; the length of the text if it has neither. Both are looked for in
// short pieces: in a file without CR, a search for the first one would run to the end of the file
// for every line.
std::size_t find_line_end(std::string_view text) {
  constexpr std::size_t kPiece = 256;
  for (std::size_t first = 0; first < text.size(); first += kPiece) {
    std::string_view piece = text.substr(first, kPiece);
    const std::size_t lf = piece.find('\n');
    piece = piece.substr(0, lf);
    const std::size_t cr = piece.find('\r');
    if (cr != piece.npos) return first + cr;
    if (lf != piece.npos) return first + lf;
  }
  return text.size();
}
constexpr std::size_t kLongestQuote = 40;  // characters, so that a message stays readable

}  // namespace

bool next_line(std::string_view& rest, std::string_view& line) {
  if (rest.empty()) return false;
  const std::size_t end = find_line_end(rest);
  line = rest.substr(0, end);
  if (end == rest.size()) {
    rest = {};
    return true;
  }
  // CR LF is one line end of two characters.
  const bool two = rest[end] == '\r' && end + 1 < rest.size() && rest[end + 1] == '\n';
  rest.remove_prefix(end + (two ? 2 : 1));
  return true;
}

std::string_view trimmed(std::string_view field) {
  while (!field.empty() && is_white_space(field.front())) field.remove_prefix(1);
  while (!field.empty() && is_white_space(field.back())) field.remove_suffix(1);
  return field;
}

std::string_view columns(std::string_view line, std::size_t first, std::size_t count) {
  return first < line.size() ? line.substr(first, count) : std::string_view{};
}

std::vector<std::string_view> split_at_blanks(std::string_view line) {
  std::vector<std::string_view> fields;
  std::size_t at = line.find_first_not_of(kBlanks);
  while (at != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
    fields.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(kBlanks, end);
  }
  return fields;
}

// Reads [-]digits[.digits] of at most 15 digits, and nothing else. The digits are an integer below
// 2^53 and the power of ten is below 10^22, so doubles hold both exactly, and their quotient is
// rounded once, as from_chars() rounds the number (Clinger, "How to read floating point numbers
// accurately", 1990).
std::optional<double> short_decimal(std::string_view value) {
  constexpr std::size_t kMostDigits = 15;
  static constexpr std::array<double, kMostDigits + 1> kPowers{
      1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  const bool is_negative = value.starts_with('-');
  if (is_negative) value.remove_prefix(1);
  if (value.size() > kMostDigits + 1) return std::nullopt;
  std::int64_t number = 0;
  std::size_t digits = 0, point = value.size();
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (is_digit(value[i])) {
      number = 10 * number + (value[i] - '0');
      ++digits;
    } else if (value[i] == '.' && point == value.size()) {
      point = i;
    } else {
      return std::nullopt;
    }
  }
  if (digits == 0 || digits > kMostDigits) return std::nullopt;
  const std::size_t decimals = point == value.size() ? 0 : value.size() - point - 1;
  const double magnitude = static_cast<double>(number) / kPowers[decimals];
  return is_negative ? -magnitude : magnitude;
}

std::optional<double> finite_number(std::string_view field) {
  field = trimmed(field);
  if (const std::optional<double> number = short_decimal(field)) return number;
  // read_double() accepts no plus sign, so the sign is removed first. "+-3" keeps it and is
  // refused.
  if (field.starts_with('+') && !field.starts_with("+-")) field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = read_double(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::optional<std::int64_t> whole_number(std::string_view field) {
  field = trimmed(field);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (field.empty() || error != std::errc() || end != field.data() + field.size())
    return std::nullopt;
  return value;
}

double number_or_refuse(std::string_view field, std::string_view what, const std::string& path,
                        std::uint32_t line) {
  if (const std::optional<double> value = finite_number(field)) return *value;
  throw FileFormatError(
      fmt::format("{}:{}: {} is {}, not a finite number", path, line, what, in_quotes(field)));
}

std::string in_quotes(std::string_view field) {
  std::string text = "'";
  for (const char c : field.substr(0, kLongestQuote)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (field.size() > kLongestQuote ? "...'" : "'");
}

std::string one_line(std::string_view message) {
  std::string line;
  for (const char c : trimmed(message)) {
    const bool blank = c == '\n' || c == '\r' || c == '\t' || c == ' ';
    if (!blank) line += c;
    if (blank && !line.ends_with(' ')) line += ' ';
  }
  return line;
}

}  // namespace vdwmesh
