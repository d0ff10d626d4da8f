// Pictures of surfaces, drawn with OpenGL off screen: no window and no display server is needed,
// and Mesa's software rasterizer will do.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "render/camera.hpp"
#include "render/picture.hpp"
#include "render/surface_source.hpp"

namespace vdwmesh {

// Where light is computed: at the vertices and interpolated (H. Gouraud 1971), or at every pixel
// with the interpolated normal (B. T. Phong 1975). The model is J. F. Blinn's of 1977, in linear
// light.
enum class Shading { gouraud, per_pixel };

// Shares of the light that comes back.
struct Material {
  float ambient = 0.35f, diffuse = 0.75f, specular = 0.12f;
  float shininess = 40;  // exponent of the highlight
};

struct RenderOptions {
  int width = 1200, height = 900;  // pixels
  View view;
  CameraProjection projection = CameraProjection::orthographic;
  double margin = 0.04;  // empty border, as a share of the picture
  Shading shading = Shading::per_pixel;
  Material material;
  Vec3f light{-0.45f, 0.6f, 1.0f};           // toward it, along the picture's right, up and viewer
  std::optional<Rgb> background{{1, 1, 1}};  // none: transparent
  int samples_per_axis = 3;                  // antialiasing: its square per pixel, 1 to 8
  std::uint64_t memory_limit = ~std::uint64_t{0};  // bytes, of buffers and picture
};

// Most pixels along a side of a picture, where the device has no lower limit.
inline constexpr int kMaxPictureSide = 16384;

class Renderer {
 public:
  // Opens an OpenGL 3.3 core context: on the first EGL device that gives one (hardware first), else
  // on Mesa's surfaceless platform. Throws BackendUnavailable with the reason, also in a build
  // without the libraries.
  Renderer();
  ~Renderer();
  Renderer(Renderer&&) noexcept;

  // What draws: "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5".
  const std::string& device() const;

  // Its number in CUDA, where its driver has one for it; none for other devices.
  std::optional<int> cuda_device() const;

  // The surface from outside and, where it is open, its inside; with a colour bar below where it
  // shows values. The same input gives the same picture, bit for bit, on the same device. Throws
  // InvalidInput for options out of range and where not a pixel is covered, LimitExceeded where
  // picture or buffers need more than memory_limit or the device has.
  Picture draw(const SurfaceSource& surface, const RenderOptions& options) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vdwmesh
