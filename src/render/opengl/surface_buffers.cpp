// Allocates the buffers of a surface, maps them on demand while the source fills them, and binds
// them for drawing. The values of triangles go into a buffer texture, from which the fragment
// shader fetches the value by the number of the triangle.
#include "render/opengl/surface_buffers.hpp"

#include <cstddef>

#include "render/opengl/surface_program.hpp"

namespace vdwmesh {
namespace {

// Bytes of the values of triangles; 0 if these are not painted.
std::uint64_t value_bytes(PaintKind paint, std::uint64_t triangles) {
  return paint == PaintKind::triangle_value ? triangles * sizeof(float) : 0;
}

// Gives a buffer its size and checks that the device has granted it.
void allocate_buffer(GLenum target, GLuint name, std::uint64_t bytes, std::string_view what) {
  glBindBuffer(target, name);
  glBufferData(target, static_cast<GLsizeiptr>(bytes), nullptr, GL_STATIC_DRAW);
  check_gl(what);
  GLint64 size = 0;
  glGetBufferParameteri64v(target, GL_BUFFER_SIZE, &size);
  if (static_cast<std::uint64_t>(size) != bytes) {
    throw LimitExceeded(
        fmt::format("the OpenGL device holds {} of the {} bytes of {}", size, bytes, what));
  }
}

// Maps a buffer of `count` elements to host memory for writing. The former content of the buffer is
// lost, so every element must be written.
template <class T>
T* map(GLenum target, GLuint name, std::uint64_t count) {
  glBindBuffer(target, name);
  void* memory = glMapBufferRange(target, 0, static_cast<GLsizeiptr>(count * sizeof(T)),
                                  GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
  check_gl("a mapped buffer");
  if (!memory) throw LimitExceeded("the OpenGL device's buffers cannot be mapped to memory");
  return static_cast<T*>(memory);
}

// Unmaps a buffer if it is mapped (not null), and sets `mapped` to null. glUnmapBuffer() returns
// false if the device has lost the content of the buffer while it was mapped.
template <class T>
void unmap_buffer(GLenum target, GLuint name, T*& mapped) {
  if (!mapped) return;
  mapped = nullptr;
  glBindBuffer(target, name);
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

std::uint64_t buffer_bytes(const SurfaceSource& source) {
  return source.vertex_count() * sizeof(SurfaceVertex) +
         source.triangle_count() * sizeof(Triangle) +
         value_bytes(source.paint(), source.triangle_count());
}

SurfaceBuffers::SurfaceBuffers(const SurfaceSource& source, const Vec3d& origin)
    : vertex_count_(source.vertex_count()),
      triangle_count_(source.triangle_count()),
      paint_(source.paint()) {
  // A vertex array object records the index buffer that is bound while the object itself is bound.
  // So it is bound before allocate() binds the index buffer.
  glBindVertexArray(array_.name());
  allocate();
  source.fill(*this, origin);
  unmap();
  describe_vertices();
  check_gl("the surface");
}

SurfaceBuffers::~SurfaceBuffers() = default;

void SurfaceBuffers::allocate() const {
  allocate_buffer(GL_ARRAY_BUFFER, vertex_buffer_.name(), vertex_count_ * sizeof(SurfaceVertex),
                  "the vertices");
  allocate_buffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer_.name(), triangle_count_ * sizeof(Triangle),
                  "the triangles");
  if (paint_ != PaintKind::triangle_value) return;
  check_texture_size(triangle_count_);
  allocate_buffer(GL_TEXTURE_BUFFER, value_buffer_.name(), value_bytes(paint_, triangle_count_),
                  "the values of triangles");
}

std::span<SurfaceVertex> SurfaceBuffers::vertices() {
  if (!mapped_vertices_) {
    mapped_vertices_ = map<SurfaceVertex>(GL_ARRAY_BUFFER, vertex_buffer(), vertex_count_);
  }
  return {mapped_vertices_, vertex_count_};
}

std::span<Triangle> SurfaceBuffers::triangles() {
  if (!mapped_triangles_) {
    mapped_triangles_ = map<Triangle>(GL_ELEMENT_ARRAY_BUFFER, index_buffer(), triangle_count_);
  }
  return {mapped_triangles_, triangle_count_};
}

std::span<float> SurfaceBuffers::triangle_values() {
  if (paint_ != PaintKind::triangle_value) return {};
  if (!mapped_values_) {
    mapped_values_ = map<float>(GL_TEXTURE_BUFFER, value_buffer_.name(), triangle_count_);
  }
  return {mapped_values_, triangle_count_};
}

void SurfaceBuffers::unmap() {
  unmap_buffer(GL_ARRAY_BUFFER, vertex_buffer_.name(), mapped_vertices_);
  unmap_buffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer_.name(), mapped_triangles_);
  unmap_buffer(GL_TEXTURE_BUFFER, value_buffer_.name(), mapped_values_);
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
