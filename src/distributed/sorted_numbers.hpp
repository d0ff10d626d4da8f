// Numbers of vertices of the whole mesh: sorted arrays of them, and names by 32 bits.
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

// The number whose last 32 bits are `name`, among the 2^32 numbers from `lowest` on.
constexpr std::uint64_t number_from_name(std::uint32_t name, std::uint64_t lowest) {
  return lowest + (name - static_cast<std::uint32_t>(lowest));
}

}  // namespace vdwmesh
