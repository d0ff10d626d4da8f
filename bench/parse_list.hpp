// Arguments that are lists of numbers.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace vdwmesh {

// "0.5,0.25" -> 0.5, 0.25
inline std::vector<double> parse_list(const std::string& text) {
  std::vector<double> values;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    values.push_back(std::stod(text.substr(at, comma - at)));
    at = comma + 1;
  }
  return values;
}

}  // namespace vdwmesh
