// Reads decimal numbers by std::from_chars, which knows no locale, with its gap at 0 closed.
#pragma once

#include <charconv>
#include <cstdint>
#include <system_error>

#include "core/letters.hpp"

namespace vdwmesh {

// Whether the decimal number in [first, last) is below 1: whether the power of ten of its first
// digit that is not 0 is negative. Hardly ever called, so not inlined into loops that read numbers.
[[gnu::noinline]] inline bool is_small_decimal(const char* first, const char* last) {
  std::int64_t power = 0;
  bool is_behind_point = false, has_digit = false;
  for (; first != last && *first != 'e' && *first != 'E'; ++first) {
    if (*first == '.') is_behind_point = true;
    if (!is_digit(*first)) continue;
    if (is_behind_point && !has_digit) --power;
    if (!is_behind_point && has_digit) ++power;
    has_digit = has_digit || *first != '0';
  }
  if (first == last) return power < 0;
  ++first;
  if (first != last && *first == '+') ++first;
  std::int64_t exponent = 0;
  // An exponent of more than 64 bits is larger than the number of digits in any text.
  if (std::from_chars(first, last, exponent).ec != std::errc{}) return *first == '-';
  return exponent < -power;
}

// As std::from_chars, which refuses what is too close to 0 for a double ("1e-400"); here it becomes
// the nearest double, which is 0. A number that is too large stays an error.
inline std::from_chars_result read_double(const char* first, const char* last, double& value) {
  std::from_chars_result result = std::from_chars(first, last, value);
  if (result.ec == std::errc::result_out_of_range && is_small_decimal(first, result.ptr))
      [[unlikely]] {
    value = *first == '-' ? -0.0 : 0.0;
    result.ec = std::errc{};
  }
  return result;
}

}  // namespace vdwmesh
