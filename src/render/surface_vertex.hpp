// A vertex as it lies in the renderer's buffer, and the formula that makes it, for host and device:
// whoever fills the buffer, its bytes are the same.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/vec3.hpp"
#include "render/color_map.hpp"

namespace vdwmesh {

struct SurfaceVertex {
  Vec3f position;  // Å, relative to Camera::origin
  Vec3f normal;    // unit, outward
  std::array<std::uint8_t, 4> color;
  float value;
};
static_assert(sizeof(SurfaceVertex) == 32);

// What vertices are made of, array by array: a view of host or device memory.
struct VertexArrays {
  const Vec3d* positions = nullptr;  // Å
  const Vec3f* normals = nullptr;
  const Rgb* colors = nullptr;    // none: all have `color`
  const float* values = nullptr;  // none: 0
  Rgb color{0, 0, 0};
};

VDWMESH_HD inline SurfaceVertex surface_vertex(const VertexArrays& arrays, std::size_t v,
                                               const Vec3d& origin) {
  const std::array<std::uint8_t, 3> bytes =
      to_bytes(arrays.colors ? arrays.colors[v] : arrays.color);
  return {cast<float>(arrays.positions[v] - origin),
          arrays.normals[v],
          {bytes[0], bytes[1], bytes[2], 255},
          arrays.values ? arrays.values[v] : 0};
}

}  // namespace vdwmesh
