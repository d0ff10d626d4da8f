// Kinds of characters, and capital and small letters for names that match either way. Letters are
// those of ASCII, whatever the locale of the process is.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace vdwmesh {

inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
inline bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }
inline bool is_small_letter(char c) { return c >= 'a' && c <= 'z'; }
inline bool is_letter(char c) { return is_capital(c) || is_small_letter(c); }

inline char upper_case(char c) { return is_small_letter(c) ? static_cast<char>(c - 'a' + 'A') : c; }
inline char lower_case(char c) { return is_capital(c) ? static_cast<char>(c - 'A' + 'a') : c; }

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
