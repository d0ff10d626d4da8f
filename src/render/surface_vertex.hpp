// The layout of a vertex in the renderer's buffer, and the formula that makes it. Host and device
// share the formula, so the bytes are the same whichever fills the buffer.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/vec3.hpp"
#include "render/color_map.hpp"

namespace vdwmesh {

// The attributes of one vertex; the shaders read them from the buffer.
struct SurfaceVertex {
  Vec3f position;                     // Å, relative to Camera::origin
  Vec3f normal;                       // unit, outward
  std::array<std::uint8_t, 4> color;  // sRGB; alpha is always 255
  float value;                        // in the unit of the colour scale; 0 if no values are painted
};
static_assert(sizeof(SurfaceVertex) == 32);

// The arrays from which vertices are made: a view of host or device memory.
struct VertexArrays {
  const Vec3d* positions = nullptr;  // Å
  const Vec3f* normals = nullptr;    // unit, outward
  const Rgb* colors = nullptr;       // null: all vertices have `color`
  const float* values = nullptr;     // null: all values are 0
  Rgb color{0, 0, 0};
};

// Vertex v of the arrays. The difference is taken in double before it becomes float, which keeps
// the digits of vertices far from the coordinate origin.
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
