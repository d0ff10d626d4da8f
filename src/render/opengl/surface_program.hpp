// The shader program that draws a surface.
#pragma once

#include <epoxy/gl.h>

#include "render/renderer.hpp"

namespace vdwmesh {

// Locations of the vertex attributes, which hold the members of a SurfaceVertex.
enum SurfaceAttribute : GLuint { kPosition = 0, kNormal = 1, kColor = 2, kValue = 3 };

// The compiled and linked shaders. The context must be current in every call, destructor included.
class SurfaceProgram {
 public:
  // Compiles and links. Throws Error with the first line of the compiler's or linker's log.
  explicit SurfaceProgram(const RenderOptions& options);
  ~SurfaceProgram();
  SurfaceProgram(const SurfaceProgram&) = delete;
  SurfaceProgram& operator=(const SurfaceProgram&) = delete;

  // Makes the program current and sets the uniform variables that stay the same for one picture.
  // The palette is read from texture unit 0 and the values of triangles from unit 1. `scale` is
  // null if colours are painted, not values.
  void use(const Camera& camera, const RenderOptions& options, PaintKind paint,
           const ColorScale* scale) const;
  // Sets which layer is drawn next, counted from 0 at the front. Those behind need the depths of
  // the one before in texture unit 2 (Canvas::begin_layer()).
  void set_layer(int layer) const;
  // Sets the index of the first triangle of the next draw call, which the fragment shader adds to
  // the number of a triangle within the call.
  void set_first_triangle(std::uint64_t triangle) const;

 private:
  // Location of a uniform variable.
  GLint place(const char* uniform) const;

  GLuint name_ = 0;
};

}  // namespace vdwmesh
