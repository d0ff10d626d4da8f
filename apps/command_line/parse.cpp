// Numbers are read by std::from_chars, which knows no locale, and must fill the whole text: "0.5x"
// is no number. What is too close to 0 for a double is 0, as in files. A leading plus, which
// from_chars does not take, is taken off first.
#include "command_line/parse.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <type_traits>

#include "core/errors.hpp"
#include "core/read_double.hpp"
#include "request/refuse.hpp"

namespace vdwmesh::apps {
namespace {

template <class T>
bool read_whole(std::string_view text, T& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const char *begin = text.data(), *end = begin + text.size();
  std::from_chars_result result;
  if constexpr (std::is_floating_point_v<T>) {
    result = read_double(begin, end, value);
  } else {
    result = std::from_chars(begin, end, value);
  }
  return !text.empty() && result.ec == std::errc() && result.ptr == end;
}

// Comparisons that NaN fails, so that it is in no range.
bool in_range(double value, Range range) {
  if (!std::isfinite(value)) return false;
  if (range == Range::positive) return value > 0;
  return range == Range::finite || value >= 0;
}

std::string_view words_for(Range range) {
  if (range == Range::positive) return "a finite number above 0";
  return range == Range::non_negative ? "a finite number, 0 or more" : "a finite number";
}

// "8GiB", "8GB" and "8B" -> "8G", "8G" and "8".
std::string_view without_byte_letters(std::string_view text) {
  if (text.ends_with("iB")) return text.substr(0, text.size() - 2);
  if (text.ends_with('B')) return text.substr(0, text.size() - 1);
  return text;
}

}  // namespace

double parse_number(std::string_view option, std::string_view text, Range range,
                    std::string_view example) {
  double value = 0;
  refuse_if(!read_whole(text, value) || !in_range(value, range),
            "{} {}: needs {}, for example {} {}", option, text, words_for(range), option, example);
  return value;
}

std::int64_t parse_integer(std::string_view option, std::string_view text, std::int64_t lowest,
                           std::int64_t highest) {
  std::int64_t value = 0;
  refuse_if(!read_whole(text, value) || value < lowest || value > highest,
            "{} {}: needs a whole number from {} to {}", option, text, lowest, highest);
  return value;
}

// Suffixes are binary, as memory is; "8GB" means the same as "8G", because people write it so.
std::uint64_t parse_bytes(std::string_view option, std::string_view text) {
  constexpr std::string_view kSuffixes = "kKmMgGtT";
  std::string_view number = without_byte_letters(text);
  const std::size_t suffix = number.empty() ? kSuffixes.npos : kSuffixes.find(number.back());
  if (suffix != kSuffixes.npos) number.remove_suffix(1);
  const int exponent = suffix == kSuffixes.npos ? 0 : 10 * (static_cast<int>(suffix / 2) + 1);
  double value = 0;
  const bool read = read_whole(number, value) && in_range(value, Range::positive);
  const double bytes = std::ldexp(value, exponent);
  refuse_if(!read || bytes < 1 || bytes >= 0x1p63,
            "{} {}: needs a number of bytes above 0, for example {} 8G or {} 500M", option, text,
            option, option);
  return static_cast<std::uint64_t>(bytes);
}

}  // namespace vdwmesh::apps
