// Numbers are read by std::from_chars, which knows no locale, and must fill the whole text: "0.5x"
// is no number. A leading plus, which from_chars does not take, is taken off first.
#include "command_line/parse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/errors.hpp"
#include "refuse.hpp"

namespace vdwmesh::apps {
namespace {

template <class T>
bool read_whole(std::string_view text, T& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const char *begin = text.data(), *end = begin + text.size();
  const std::from_chars_result result = std::from_chars(begin, end, value);
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

// What the field, or another program, calls something that has another name here.
struct Synonym {
  std::string_view given, here, besides;
};
constexpr Synonym kSynonyms[] = {
    {"ses", "excluded", ""},
    {"connolly", "excluded", ""},
    {"sas", "vdw", ", which is the accessible surface with --probe 1.4"},
    {"gpu", "cuda", ""},
    {"mc", "marching-cubes", ""}};

using Distances = std::vector<std::size_t>;

// Three rows of the usual table are enough: a swap looks two rows back.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  Distances before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row.back();
}

// The dashes of options are no letters that somebody mistypes.
std::size_t letters(std::string_view name) {
  return name.size() - static_cast<std::size_t>(std::ranges::count(name, '-'));
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

std::string list_names(std::span<const std::string_view> names) {
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) list += i + 1 == names.size() ? " or " : ", ";
    list += names[i];
  }
  return list;
}

std::string suggestion(std::string_view given, std::span<const std::string_view> known) {
  for (const Synonym& s : kSynonyms) {
    const bool is_meant = s.given == given && std::ranges::find(known, s.here) != known.end();
    if (is_meant) return fmt::format("; did you mean {}{}?", s.here, s.besides);
  }
  std::string_view closest;
  std::size_t least = letters(given) > 5 ? 3 : letters(given) > 1 ? 2 : 0;
  for (const std::string_view name : known) {
    // With one letter of three wrong it is another word ("gpu", "cpu") more often than a slip.
    if (letters(given) < 4 && !name.starts_with(given.substr(0, 1))) continue;
    const std::size_t distance = edit_distance(given, name);
    if (distance > least) continue;
    closest = distance < least ? name : "";  // which of two as close was meant, nobody knows
    least = distance;
  }
  return closest.empty() ? "" : "; did you mean " + std::string(closest) + "?";
}

void throw_unknown_name(std::string_view option, std::string_view text,
                        std::span<const std::string_view> known) {
  throw InvalidInput(fmt::format("{} {}: not known; choose {}{}", option, text, list_names(known),
                                 suggestion(text, known)));
}

}  // namespace vdwmesh::apps
