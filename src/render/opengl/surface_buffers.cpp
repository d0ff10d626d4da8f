// Allocates the buffers of a surface, maps each while the source writes it, and binds them for
// drawing. The values of triangles go into a buffer texture, from which the fragment shader fetches
// the value by the number of the triangle.
#include "render/opengl/surface_buffers.hpp"

#include <cstddef>

#include "render/opengl/surface_program.hpp"

namespace vdwmesh {
namespace {

// Gives a buffer `count` elements and has them written while they are mapped to host memory. Checks
// that the device has granted the memory, and that it has not lost the content meanwhile.
template <class T, class Write>
void fill_buffer(GLenum target, const GlObject& buffer, std::uint64_t count, std::string_view what,
                 const Write& write) {
  const std::uint64_t bytes = count * sizeof(T);
  glBindBuffer(target, buffer.name());
  glBufferData(target, static_cast<GLsizeiptr>(bytes), nullptr, GL_STATIC_DRAW);
  check_gl(what);
  GLint64 size = 0;
  glGetBufferParameteri64v(target, GL_BUFFER_SIZE, &size);
  if (static_cast<std::uint64_t>(size) != bytes) {
    throw LimitExceeded(
        fmt::format("the OpenGL device holds {} of the {} bytes of {}", size, bytes, what));
  }
  void* memory = glMapBufferRange(target, 0, static_cast<GLsizeiptr>(bytes),
                                  GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
  check_gl("a mapped buffer");
  if (!memory) throw LimitExceeded("the OpenGL device's buffers cannot be mapped to memory");
  write(std::span(static_cast<T*>(memory), count));
  if (!glUnmapBuffer(target)) throw Error("the OpenGL device lost a buffer");
}

// Throws LimitExceeded if a buffer texture cannot hold a value per triangle.
void check_texture_size(std::uint64_t triangles) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  if (triangles <= static_cast<std::uint64_t>(most)) return;
  throw LimitExceeded(fmt::format(
      "{} triangles have a value each, and the OpenGL device takes {}; a coarser mesh or colours "
      "by vertex need less",
      triangles, most));
}

}  // namespace

std::uint64_t buffer_bytes(const MeshSource& source) {
  const bool has_values = source.paint() == PaintKind::triangle_value;
  return source.vertex_count() * sizeof(SurfaceVertex) +
         source.triangle_count() * (sizeof(Triangle) + (has_values ? sizeof(float) : 0));
}

SurfaceBuffers::SurfaceBuffers(const MeshSource& source, const Vec3d& origin)
    : paint_(source.paint()) {
  // A vertex array object records the index buffer that is bound while the object itself is bound.
  glBindVertexArray(array_.name());
  fill_buffer<SurfaceVertex>(GL_ARRAY_BUFFER, vertex_buffer_, source.vertex_count(), "the vertices",
                             [&](auto vertices) { source.write_vertices(vertices, origin); });
  fill_buffer<Triangle>(GL_ELEMENT_ARRAY_BUFFER, index_buffer_, source.triangle_count(),
                        "the triangles",
                        [&](auto triangles) { source.write_triangles(triangles); });
  if (paint_ == PaintKind::triangle_value) {
    check_texture_size(source.triangle_count());
    fill_buffer<float>(GL_TEXTURE_BUFFER, value_buffer_, source.triangle_count(),
                       "the values of triangles",
                       [&](auto values) { source.write_triangle_values(values); });
  }
  describe_vertices();
  check_gl("the surface");
}

void SurfaceBuffers::describe_vertices() const {
  glBindBuffer(GL_ARRAY_BUFFER, vertex_buffer_.name());
  const auto attribute = [](GLuint place, GLint size, GLenum type, GLboolean normalized,
                            std::size_t offset) {
    glEnableVertexAttribArray(place);
    glVertexAttribPointer(place, size, type, normalized, sizeof(SurfaceVertex),
                          buffer_offset(offset));
  };
  attribute(kPosition, 3, GL_FLOAT, GL_FALSE, offsetof(SurfaceVertex, position));
  attribute(kNormal, 3, GL_FLOAT, GL_FALSE, offsetof(SurfaceVertex, normal));
  attribute(kColor, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(SurfaceVertex, color));
  attribute(kValue, 1, GL_FLOAT, GL_FALSE, offsetof(SurfaceVertex, value));
}

void SurfaceBuffers::bind() const {
  glBindVertexArray(array_.name());
  if (paint_ != PaintKind::triangle_value) return;
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_BUFFER, value_texture_.name());
  glTexBuffer(GL_TEXTURE_BUFFER, GL_R32F, value_buffer_.name());
}

}  // namespace vdwmesh
