// The pseudo-random generator SplitMix64 (G. L. Steele, D. Lea and C. H. Flood, OOPSLA 2014).
#pragma once

#include <cstdint>

namespace vdwmesh {

// What the generator adds to its state for each number: 2^64 divided by the golden ratio.
inline constexpr std::uint64_t kSplitMixStep = 0x9e3779b97f4a7c15u;

// The number of a state: the generator's finaliser, a bijection of 64 bits.
constexpr std::uint64_t split_mix(std::uint64_t state) {
  state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9u;
  state = (state ^ (state >> 27)) * 0x94d049bb133111ebu;
  return state ^ (state >> 31);
}

}  // namespace vdwmesh
