// How the text of an option becomes the typed value of its field. What reads a value also knows
// what --help says about it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "command_line/names.hpp"
#include "command_line/parse.hpp"
#include "core/errors.hpp"

namespace vdwmesh::apps {

// Values of one kind. `parse` throws InvalidInput, naming the option, for a text that is none.
template <class T>
struct Kind {
  std::string value;     // what stands for a value in --help: "Å", "N", "FILE"
  std::string accepted;  // "cpu or cuda"; empty where it is not one of a few names
  std::function<T(std::string_view option, const std::string& text)> parse;
  std::vector<std::string_view> words = {};  // that completion in a shell offers for a value
};

inline Kind<double> number(std::string unit, Range range, std::string example) {
  return {std::move(unit), "", [=](std::string_view option, const std::string& text) {
            return parse_number(option, text, range, example);
          }};
}

template <class Integer>
Kind<Integer> whole(std::int64_t lowest, std::int64_t highest) {
  return {"N", "", [=](std::string_view option, const std::string& text) {
            return static_cast<Integer>(parse_integer(option, text, lowest, highest));
          }};
}

template <class T>
Kind<T> named() {
  return {"NAME", list_names(all_names<T>()), value_named<T>, all_names<T>()};
}

// Any text, of which some are usual.
inline Kind<std::string> text(std::string value, std::vector<std::string_view> words = {}) {
  return {std::move(value), "", [](std::string_view, const std::string& text) { return text; },
          std::move(words)};
}

// How often an option may be given, and whether its value is a file that is read or written.
enum class Times { once, often };
enum class Use { none, reads, writes };

// Fills one field; an empty `value` is that of a flag, which has no text.
struct Reader {
  std::string value, accepted;
  std::function<void(std::string_view option, const std::string& text)> read;
  Use use = Use::none;
  Times times = Times::once;
  std::vector<std::string_view> words = {};  // as in Kind
};

template <class Field>
Reader flag(Field& field, Field set) {
  return {"", "", [=, &field](std::string_view, const std::string&) { field = set; }};
}

// The field may be a std::optional.
template <class Field, class T>
Reader one(Field& field, Kind<T> kind, Use use = Use::none) {
  return {kind.value,
          kind.accepted,
          [parse = kind.parse, &field](std::string_view option, const std::string& text) {
            field = parse(option, text);
          },
          use,
          Times::once,
          std::move(kind.words)};
}

// "a,b,c": each value once, in the order given.
template <class T>
Reader several(std::vector<T>& field, Kind<T> kind) {
  const auto read = [parse = kind.parse, &field](std::string_view option, const std::string& text) {
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
      const T value = parse(option, part);
      if (std::ranges::find(field, value) == field.end()) field.push_back(value);
    }
    if (!field.empty()) return;
    throw InvalidInput(std::string(option) + ": needs at least one value, or several with commas");
  };
  return {kind.value + ",...", kind.accepted, read, Use::none, Times::often, std::move(kind.words)};
}

}  // namespace vdwmesh::apps
