// Words that every kernel uses about warps, and the sums over their lanes that make room in lists.
#pragma once

#include <cstdint>

namespace vdwmesh {

inline constexpr unsigned kWarp = 32;               // lanes of a warp
inline constexpr unsigned kAllLanes = 0xffffffffu;  // a bit for each lane: all take part

// How many bits of the mask are below the lane's own.
__device__ inline unsigned bits_below(unsigned mask, unsigned lane) {
  return static_cast<unsigned>(__popc(mask & ((1u << lane) - 1)));
}

// Joins the values of lanes by join(a, b), which does not depend on the order of a and b: each lane
// gets what all lanes have that differ from it in the bits from kFrom down to kTo of their number.
// All lanes must call it together.
template <unsigned kFrom = kWarp / 2, unsigned kTo = 1, class T, class Join>
__device__ __forceinline__ T joined_by_warp(T x, const Join& join) {
#pragma unroll
  for (unsigned step = kFrom; step >= kTo; step /= 2) {
    x = join(x, __shfl_xor_sync(kAllLanes, x, static_cast<int>(step)));
  }
  return x;
}

// The sum of the arguments of this lane and all lower lanes. All lanes must call it together.
// The shuffle itself says whether there is a lane `step` below, which saves a comparison.
__device__ inline std::uint32_t warp_inclusive_sum(std::uint32_t sum) {
#pragma unroll
  for (unsigned step = 1; step < kWarp; step *= 2) {
    asm volatile(
        "{\n\t"
        ".reg .u32 below;\n\t"
        ".reg .pred there;\n\t"
        "shfl.sync.up.b32 below|there, %0, %1, 0, %2;\n\t"
        "@there add.u32 %0, %0, below;\n\t"
        "}"
        : "+r"(sum)
        : "r"(step), "r"(kAllLanes));
  }
  return sum;
}

}  // namespace vdwmesh
