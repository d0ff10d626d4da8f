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

// Owns one OpenGL name. Traits::generate() makes it and Traits::release() deletes it.
template <class Traits>
class GlObject {
 public:
  GlObject() { Traits::generate(&name_); }
  ~GlObject() { Traits::release(&name_); }
  GlObject(const GlObject&) = delete;
  GlObject& operator=(const GlObject&) = delete;
  GLuint name() const { return name_; }

 private:
  GLuint name_ = 0;
};

struct BufferTraits {
  static void generate(GLuint* name) { glGenBuffers(1, name); }
  static void release(const GLuint* name) { glDeleteBuffers(1, name); }
};
struct TextureTraits {
  static void generate(GLuint* name) { glGenTextures(1, name); }
  static void release(const GLuint* name) { glDeleteTextures(1, name); }
};
struct VertexArrayTraits {
  static void generate(GLuint* name) { glGenVertexArrays(1, name); }
  static void release(const GLuint* name) { glDeleteVertexArrays(1, name); }
};
struct RenderbufferTraits {
  static void generate(GLuint* name) { glGenRenderbuffers(1, name); }
  static void release(const GLuint* name) { glDeleteRenderbuffers(1, name); }
};
struct FramebufferTraits {
  static void generate(GLuint* name) { glGenFramebuffers(1, name); }
  static void release(const GLuint* name) { glDeleteFramebuffers(1, name); }
};

using GlBuffer = GlObject<BufferTraits>;
using GlTexture = GlObject<TextureTraits>;
using GlVertexArray = GlObject<VertexArrayTraits>;
using GlRenderbuffer = GlObject<RenderbufferTraits>;
using GlFramebuffer = GlObject<FramebufferTraits>;

}  // namespace vdwmesh
