// Words that every kernel uses about warps.
#pragma once

namespace vdwmesh {

inline constexpr unsigned kWarp = 32;               // lanes of a warp
inline constexpr unsigned kAllLanes = 0xffffffffu;  // a bit for each lane: all take part

}  // namespace vdwmesh
