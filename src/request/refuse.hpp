// Refusals of bad input, in one line of text each, and how the program and Python write an option
// in such a line.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

#include "core/errors.hpp"

namespace vdwmesh {

// Says what, where and what would work. Throws InvalidInput.
template <class... Values>
[[noreturn]] void refuse(fmt::format_string<Values...> message, Values&&... values) {
  throw InvalidInput(fmt::format(message, std::forward<Values>(values)...));
}

template <class... Values>
void refuse_if(bool wrong, fmt::format_string<Values...> message, Values&&... values) {
  if (wrong) refuse(message, std::forward<Values>(values)...);
}

// Who asks: the command line, whose options begin with dashes, or a call of Python.
enum class Door { program, python };

// "edge-length": --edge-length, or edge_length.
std::string option_name(Door door, std::string_view name);
// An option with its value, to say what would work: --mesher exact, or mesher="exact".
std::string option_with(Door door, std::string_view name, std::string_view value);
// The option at the beginning of a refusal: --min-angle 30, or min_angle: 30.
std::string refused_option(Door door, std::string_view name, std::string_view value);

}  // namespace vdwmesh
