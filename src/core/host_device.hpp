// The one place where the code asks whether it is compiled for CUDA: formulas of a few lines are
// written once, marked VDWMESH_HD, and run on host and device alike.
#pragma once

#include <cstdint>

#ifdef __CUDACC__
#define VDWMESH_HD __host__ __device__
#else
#define VDWMESH_HD
#endif

namespace vdwmesh {

VDWMESH_HD inline int count_bits(std::uint32_t bits) {
#ifdef __CUDA_ARCH__
  return __popc(bits);
#else
  return __builtin_popcount(bits);  // not std::popcount: files that include gemmi may be C++17
#endif
}

// x, or 0 where x is not above 0; for x <= 1, which lets the device clamp for free.
VDWMESH_HD inline float positive_part(float x) {
#ifdef __CUDA_ARCH__
  return __saturatef(x);
#else
  return x > 0.0f ? x : 0.0f;
#endif
}

}  // namespace vdwmesh
