// Sorted arrays of numbers of vertices of the whole mesh.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vdwmesh {

inline void sort_without_repeats(std::vector<std::uint64_t>& numbers) {
  std::ranges::sort(numbers);
  numbers.erase(std::ranges::unique(numbers).begin(), numbers.end());
}

// The place of a number in a sorted array that has it.
inline std::size_t place_in(const std::vector<std::uint64_t>& numbers, std::uint64_t number) {
  return static_cast<std::size_t>(std::ranges::lower_bound(numbers, number) - numbers.begin());
}

}  // namespace vdwmesh
