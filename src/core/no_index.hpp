// kNoIndex: what stands in place of a 32-bit index where there is none.
#pragma once

#include <cstdint>

namespace vdwmesh {

inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

}  // namespace vdwmesh
