// Kinds of characters, and capital and small letters for names that match either way.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

namespace vdwmesh {

inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
inline bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

inline char upper_case(char c) {
  return static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
}
inline char lower_case(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

inline std::string upper_case(std::string_view text) {
  std::string result(text);
  std::transform(text.begin(), text.end(), result.begin(), [](char c) { return upper_case(c); });
  return result;
}
inline std::string lower_case(std::string_view text) {
  std::string result(text);
  std::transform(text.begin(), text.end(), result.begin(), [](char c) { return lower_case(c); });
  return result;
}

}  // namespace vdwmesh
