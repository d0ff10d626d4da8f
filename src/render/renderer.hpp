// Pictures of surfaces, drawn with OpenGL off screen. No window and no display server is needed,
// and Mesa's software rasterizer is enough.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "render/camera.hpp"
#include "render/picture.hpp"
#include "render/surface_source.hpp"

namespace vdwmesh {

// Where light is computed: at the vertices, then interpolated (H. Gouraud 1971), or at every pixel
// with the interpolated normal (B. T. Phong 1975). The reflection model is J. F. Blinn's of 1977,
// computed in linear light.
enum class Shading { gouraud, per_pixel };

// How the surface reflects light. The first three members are shares of the incoming light.
struct Material {
  float ambient = 0.35f, diffuse = 0.75f, specular = 0.12f;
  float shininess = 40;  // exponent of the highlight
};

// For surfaces that know how much of the sky they see (MeshSource::shade()): most of the light
// comes from there, and little from the one direction.
inline constexpr Material kSkyLight{0.8f, 0.5f, 0.08f, 40};

struct RenderOptions {
  int width = 1200, height = 900;  // pixels
  View view;
  CameraProjection projection = CameraProjection::orthographic;
  double margin = 0.04;  // empty border on each side, as a share of the picture
  Shading shading = Shading::per_pixel;
  Material material;
  // Direction toward the light: its components to the picture's right, up and toward the viewer.
  // The length does not matter, but must not be 0.
  Vec3f light{-0.45f, 0.6f, 1.0f};
  // If there is no value, the background is transparent.
  std::optional<Rgb> background{{1, 1, 1}};
  // The share of the light from behind that each layer of the surface keeps back, above 0. Below 1
  // all layers are drawn, and each lets the rest through.
  double opacity = 1;
  // The width of black lines where the surface ends in front of what is farther, as a share of the
  // picture's smaller side; on a dark background they are white. 0: there are no lines.
  double outline = 0;
  // Antialiasing: a pixel is the mean of samples_per_axis² samples. From 1 to 8.
  int samples_per_axis = 3;
  std::uint64_t memory_limit = ~std::uint64_t{0};  // bytes, of the buffers and the picture
};

// The largest width or height of a picture. A device may have a lower limit.
inline constexpr int kMaxPictureSide = 16384;

class EglContext;

// Draws surfaces with one OpenGL context. Calls of draw() on one Renderer must not overlap in time.
class Renderer {
 public:
  // Opens an OpenGL 3.3 core context: on the first EGL device that provides one (hardware first),
  // else on Mesa's surfaceless platform. Throws BackendUnavailable with the reasons, also in a
  // build without the libraries.
  Renderer();
  ~Renderer();
  Renderer(Renderer&&) noexcept;

  // Name of the OpenGL device and its version, such as "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL
  // 4.5".
  const std::string& device() const;

  // Draws the surface. Both sides of it are visible: the outside and, if the surface is open, the
  // inside. If it shows values, a colour bar stands below it. The same input gives the same
  // picture, bit for bit, on the same device.
  //
  // Throws InvalidInput if an option is out of range or no pixel is covered. Throws LimitExceeded
  // if the picture or the buffers need more memory than memory_limit or than the device has.
  Picture draw(const MeshSource& surface, const RenderOptions& options) const;

 private:
  std::shared_ptr<EglContext> context_;  // owned alone; a build without OpenGL lacks the type
};

}  // namespace vdwmesh
