// A surface in the OpenGL buffers of the device that draws.
#pragma once

#include "render/opengl/gl_objects.hpp"
#include "render/surface_source.hpp"

namespace vdwmesh {

// The number of bytes that a source needs in buffers.
std::uint64_t buffer_bytes(const MeshSource& source);

// Owns the buffers of one surface.
class SurfaceBuffers {
 public:
  // Allocates the buffers, maps them to host memory and has the source write them. Throws
  // LimitExceeded if the device cannot hold them. The context must be current.
  SurfaceBuffers(const MeshSource& source, const Vec3d& origin);

  // Binds vertices and indices for drawing, and the values of triangles to texture unit 1.
  void bind() const;

 private:
  // Tells OpenGL the layout of a SurfaceVertex.
  void describe_vertices() const;

  PaintKind paint_;
  GlObject array_{GlKind::vertex_array};
  GlObject vertex_buffer_{GlKind::buffer}, index_buffer_{GlKind::buffer},
      value_buffer_{GlKind::buffer};
  GlObject value_texture_{GlKind::texture};
};

}  // namespace vdwmesh
