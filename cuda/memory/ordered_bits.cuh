// Doubles and floats as integers of the same order: for atomic minima and maxima, whose results do
// not depend on the order of the operations, and for those over a warp, which the device has for
// integers alone.
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

__device__ inline unsigned ordered(float x) {
  const auto bits = std::bit_cast<unsigned>(x);
  return bits >> 31 ? ~bits : bits | 1u << 31;
}
__device__ inline float from_ordered(unsigned bits) {
  return std::bit_cast<float>(bits >> 31 ? bits & ~(1u << 31) : ~bits);
}

// The least and the largest value of all lanes of a warp. All lanes must call.
__device__ inline OrderedBits least_of_warp(OrderedBits x) {
  return joined_by_warp(x, [](OrderedBits a, OrderedBits b) { return min(a, b); });
}
__device__ inline OrderedBits largest_of_warp(OrderedBits x) {
  return joined_by_warp(x, [](OrderedBits a, OrderedBits b) { return max(a, b); });
}
__device__ inline float least_of_warp(float x) {
  return from_ordered(__reduce_min_sync(kAllLanes, ordered(x)));
}
__device__ inline float largest_of_warp(float x) {
  return from_ordered(__reduce_max_sync(kAllLanes, ordered(x)));
}

}  // namespace vdwmesh
