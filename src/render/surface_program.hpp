// The shaders that draw a surface.
#pragma once

#include <epoxy/gl.h>

#include "render/renderer.hpp"

namespace vdwmesh {

// Attribute places of a SurfaceVertex.
enum SurfaceAttribute : GLuint { kPosition = 0, kNormal = 1, kColor = 2, kValue = 3 };

class SurfaceProgram {
 public:
  // Throws Error with the compiler's first complaint.
  explicit SurfaceProgram(Shading shading);
  ~SurfaceProgram();
  SurfaceProgram(const SurfaceProgram&) = delete;
  SurfaceProgram& operator=(const SurfaceProgram&) = delete;

  // Makes it current and sets what stays the same over a picture. The palette is texture unit 0,
  // the values of triangles are unit 1.
  void use(const Camera& camera, const RenderOptions& options, PaintKind paint,
           const ColorScale* scale) const;
  // Number of the first triangle of the next draw call.
  void set_first_triangle(std::uint64_t triangle) const;

 private:
  GLint place(const char* uniform) const;

  GLuint name_ = 0;
};

}  // namespace vdwmesh
