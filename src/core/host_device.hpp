// Support for functions that are compiled for the host and for the CUDA device.
//
// Formulas of a few lines are written once, in headers, and marked VDWMESH_HD. The same source then
// runs on both sides. This header is the only place that asks whether the compiler is nvcc.
#pragma once

#include <cstdint>

#ifdef __CUDACC__
#define VDWMESH_HD __host__ __device__
#else
#define VDWMESH_HD
#endif

namespace vdwmesh {

// Returns the number of set bits.
VDWMESH_HD inline int count_bits(std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  return __popc(bits);
#else
  return __builtin_popcount(bits);  // not std::popcount: files that include gemmi may be C++17
#endif
}

// Returns max(x, 0), and 0 for NaN. Precondition: x <= 1. Because of this precondition the device
// can use its saturation to [0, 1], which is a modifier of the instruction that computes x and
// costs nothing.
VDWMESH_HD inline float positive_part(float x) {
#ifdef __CUDA_ARCH__
  return __saturatef(x);
#else
  return x > 0.0f ? x : 0.0f;
#endif
}

}  // namespace vdwmesh
