// Owners of OpenGL names (RAII), and the check for errors. All functions need the context to be
// current on the calling thread; destructors need it too.
#pragma once

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

#include "core/errors.hpp"

namespace vdwmesh {

// Turns a pending OpenGL error into an exception: LimitExceeded if the device is out of memory,
// else Error. `what` names the thing that was being made, for the message.
inline void check_gl(std::string_view what) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  if (error == GL_OUT_OF_MEMORY) {
    throw LimitExceeded(
        fmt::format("the OpenGL device has not enough memory for {}; a coarser mesh or a smaller "
                    "picture needs less",
                    what));
  }
  throw Error(fmt::format("OpenGL error {:#x} at {}", error, what));
}

// An offset in bytes into the bound buffer, in the form that OpenGL expects: a pointer with these
// bits, which is never dereferenced.
inline const void* buffer_offset(std::size_t bytes) { return std::bit_cast<const void*>(bytes); }

enum class GlKind { buffer, texture, vertex_array, renderbuffer, framebuffer };

// Owns one OpenGL name.
class GlObject {
 public:
  explicit GlObject(GlKind kind) : kind_(kind) {
    if (kind == GlKind::buffer) glGenBuffers(1, &name_);
    if (kind == GlKind::texture) glGenTextures(1, &name_);
    if (kind == GlKind::vertex_array) glGenVertexArrays(1, &name_);
    if (kind == GlKind::renderbuffer) glGenRenderbuffers(1, &name_);
    if (kind == GlKind::framebuffer) glGenFramebuffers(1, &name_);
  }
  ~GlObject() {
    if (kind_ == GlKind::buffer) glDeleteBuffers(1, &name_);
    if (kind_ == GlKind::texture) glDeleteTextures(1, &name_);
    if (kind_ == GlKind::vertex_array) glDeleteVertexArrays(1, &name_);
    if (kind_ == GlKind::renderbuffer) glDeleteRenderbuffers(1, &name_);
    if (kind_ == GlKind::framebuffer) glDeleteFramebuffers(1, &name_);
  }
  GlObject(const GlObject&) = delete;
  GlObject& operator=(const GlObject&) = delete;
  GLuint name() const { return name_; }

 private:
  GlKind kind_;
  GLuint name_ = 0;
};

}  // namespace vdwmesh
