// Doubles as integers of the same order, for atomic minima and maxima, whose results do not depend
// on the order of the operations.
#pragma once

#include <bit>

#include "core/host_device.hpp"
#include "cuda/memory/warp.cuh"

namespace vdwmesh {

using OrderedBits = unsigned long long;
inline constexpr OrderedBits kMostBits = ~OrderedBits{0};  // above every double; 0 is below

__device__ inline OrderedBits ordered(double x) {
  const auto bits = std::bit_cast<OrderedBits>(x);
  return bits >> 63 ? ~bits : bits | OrderedBits{1} << 63;
}
VDWMESH_HD inline double from_ordered(OrderedBits bits) {
  return std::bit_cast<double>(bits >> 63 ? bits & ~(OrderedBits{1} << 63) : ~bits);
}

// The least and the largest value of all lanes of a warp. All lanes must call.
__device__ inline OrderedBits least_of_warp(OrderedBits x) {
  for (int step = 16; step > 0; step /= 2) x = min(x, __shfl_xor_sync(kAllLanes, x, step));
  return x;
}
__device__ inline OrderedBits largest_of_warp(OrderedBits x) {
  for (int step = 16; step > 0; step /= 2) x = max(x, __shfl_xor_sync(kAllLanes, x, step));
  return x;
}

}  // namespace vdwmesh
