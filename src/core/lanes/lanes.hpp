// Lanes: four doubles that are computed on together, by the compiler's vector extension. A
// processor without vectors of this width gets two of half the width; the results are the same bit
// for bit, since every lane is rounded by itself.
//
// A comparison of lanes in a conditional expression chooses lane by lane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace vdwmesh {

inline constexpr std::size_t kLanes = 4;
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
using LaneBits = std::int64_t __attribute__((vector_size(kLanes * sizeof(std::int64_t))));

// These functions are always inlined, so that no lanes are passed between functions: how that is
// done would depend on the processor version (core/lanes/multiversion.hpp).
#define VDWMESH_INLINE inline __attribute__((always_inline))

// Compilers warn wherever such a function is called, although it is inlined; so the warning stays
// off in the files that include this one.
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

VDWMESH_INLINE Lanes lanes_at(const double* first) {
  Lanes lanes;
  std::memcpy(&lanes, first, sizeof lanes);
  return lanes;
}

VDWMESH_INLINE void store_lanes(double* first, const Lanes& lanes) {
  std::memcpy(first, &lanes, sizeof lanes);
}

VDWMESH_INLINE Lanes all_lanes(double value) { return Lanes{value, value, value, value}; }

VDWMESH_INLINE double largest_of(const Lanes& lanes) {
  const double a = lanes[0] > lanes[1] ? lanes[0] : lanes[1];
  const double b = lanes[2] > lanes[3] ? lanes[2] : lanes[3];
  return a > b ? a : b;
}

// Makes rows of columns: element i of lane vector k becomes element k of lane vector i.
VDWMESH_INLINE void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  const Lanes ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6),
              ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7),
              cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6),
              cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}

}  // namespace vdwmesh
