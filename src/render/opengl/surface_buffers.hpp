// A surface in the OpenGL buffers of the device that draws.
#pragma once

#include "render/opengl/gl_objects.hpp"
#include "render/surface_source.hpp"

namespace vdwmesh {

// The number of bytes that a source needs in buffers.
std::uint64_t buffer_bytes(const SurfaceSource& source);

// Owns the buffers of one surface. A buffer is mapped to host memory when the source first calls
// vertices(), triangles() or triangle_values() for it; otherwise the source fills it by its OpenGL
// name, from CUDA for example.
class SurfaceBuffers : public SurfaceTarget {
 public:
  // Allocates the buffers and calls source.fill(). Throws LimitExceeded if the device cannot hold
  // them. The context must be current.
  SurfaceBuffers(const SurfaceSource& source, const Vec3d& origin);
  ~SurfaceBuffers() override;

  std::span<SurfaceVertex> vertices() override;
  std::span<Triangle> triangles() override;
  std::span<float> triangle_values() override;
  unsigned vertex_buffer() const override { return vertex_buffer_.name(); }
  unsigned index_buffer() const override { return index_buffer_.name(); }
  unsigned triangle_value_buffer() const override {
    return paint_ == PaintKind::triangle_value ? value_buffer_.name() : 0;
  }

  // Binds vertices and indices for drawing, and the values of triangles to texture unit 1.
  void bind() const;

 private:
  void allocate() const;
  // Tells OpenGL the layout of a SurfaceVertex.
  void describe_vertices() const;
  void unmap();

  std::uint64_t vertex_count_, triangle_count_;
  PaintKind paint_;
  GlObject array_{GlKind::vertex_array};
  GlObject vertex_buffer_{GlKind::buffer}, index_buffer_{GlKind::buffer},
      value_buffer_{GlKind::buffer};
  GlObject value_texture_{GlKind::texture};
  // Host memory of the buffers while they are mapped, else null.
  SurfaceVertex* mapped_vertices_ = nullptr;
  Triangle* mapped_triangles_ = nullptr;
  float* mapped_values_ = nullptr;
};

}  // namespace vdwmesh
