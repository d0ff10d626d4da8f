// Option values from text. Every function throws InvalidInput with one line that names the option,
// what was given and what would be accepted.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/errors.hpp"

namespace vdwmesh::apps {

// Finite and above zero ("--spacing"), at least zero ("--padding"), or any finite number.
enum class Range { positive, non_negative, finite };
double parse_number(std::string_view option, std::string_view text, Range range,
                    std::string_view example);

// A whole number in [lowest, highest].
std::int64_t parse_integer(std::string_view option, std::string_view text, std::int64_t lowest,
                           std::int64_t highest);

// "8G", "512M", "1000000": bytes with the binary suffixes K, M, G, T.
std::uint64_t parse_bytes(std::string_view option, std::string_view text);

// "a, b or c".
std::string list_names(std::span<const std::string_view> names);

template <class T>
using Choice = std::pair<std::string_view, T>;

[[noreturn]] void throw_unknown_name(std::string_view option, std::string_view text,
                                     std::span<const std::string_view> known);

// The value named `text`; an unknown name lists the known ones.
template <class T, std::size_t count>
T choose(std::string_view option, std::string_view text, const Choice<T> (&choices)[count]) {
  std::string_view names[count];
  for (std::size_t i = 0; i < count; ++i) {
    if (choices[i].first == text) return choices[i].second;
    names[i] = choices[i].first;
  }
  throw_unknown_name(option, text, names);
}

// The first name of `value`: the inverse of choose().
template <class T, std::size_t count>
std::string_view name_of(T value, const Choice<T> (&choices)[count]) {
  for (const Choice<T>& choice : choices) {
    if (choice.second == value) return choice.first;
  }
  return "unknown";
}

// "a,b,c" -> one value per name, each once, in the order given.
template <class Parse>
auto parse_list(std::string_view option, const std::string& text, Parse&& parse) {
  std::vector<decltype(parse(text))> values;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const auto value = parse(part);
    if (std::ranges::find(values, value) == values.end()) values.push_back(value);
  }
  if (values.empty()) {
    throw InvalidInput(std::string(option) + ": needs at least one value, or several with commas");
  }
  return values;
}

// Positive lengths in Å, longest first.
std::vector<double> parse_lengths(std::string_view option, const std::string& text);

}  // namespace vdwmesh::apps
