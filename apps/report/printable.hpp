// Text as it is shown on a terminal.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "core/errors.hpp"

namespace vdwmesh::apps {

// Control characters of files and command lines become question marks, as in error messages: a
// residue name must not move the cursor or set the title of the window.
inline std::string printable(std::string text) { return Error(std::move(text)).what(); }

// Columns on the screen: "–" and "Å" are one column and several bytes of UTF-8.
inline std::size_t columns_of(std::string_view text) {
  const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
  return static_cast<std::size_t>(std::ranges::count_if(text, begins));
}

inline std::string blanks(std::size_t width, std::string_view less) {
  const std::size_t taken = columns_of(less);
  return std::string(taken < width ? width - taken : 0, ' ');
}

}  // namespace vdwmesh::apps
