// The layout of a vertex in the renderer's buffer.
#pragma once

#include <array>
#include <cstdint>

#include "core/vec3.hpp"

namespace vdwmesh {

// The attributes of one vertex; the shaders read them from the buffer.
struct SurfaceVertex {
  Vec3f position;                     // Å, relative to Camera::origin
  Vec3f normal;                       // unit, outward
  std::array<std::uint8_t, 4> color;  // sRGB; alpha is the share of the sky that the vertex sees
  float value;                        // in the unit of the colour scale; 0 if no values are painted
};
static_assert(sizeof(SurfaceVertex) == 32);

}  // namespace vdwmesh
