// Draws one picture with OpenGL, from checks to pixels.
//
// Steps: (1) check options and memory; (2) frame the surface (camera.cpp); (3) draw it into a
// framebuffer that has samples_per_axis samples along each axis of a pixel (surface_buffers.cpp,
// surface_program.cpp); (4) read the samples back and average them (samples.cpp); (5) add the
// colour bar (legend.cpp). Averaging is done here and not by OpenGL's multisampling, whose sample
// positions depend on the driver.
#include "render/renderer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/errors.hpp"
#include "render/opengl/egl_context.hpp"
#include "render/opengl/gl_objects.hpp"
#include "render/opengl/legend.hpp"
#include "render/opengl/samples.hpp"
#include "render/opengl/surface_buffers.hpp"
#include "render/opengl/surface_program.hpp"

namespace vdwmesh {
namespace {

// Colours in the texture of a colour map; OpenGL interpolates between them.
constexpr int kPaletteSize = 256;
constexpr int kMostSamplesPerAxis = 8;
// The most triangles in one draw call: their 3 · 2^28 indices are counted in a GLsizei, whose
// largest value is 2^31 - 1.
constexpr std::uint64_t kTrianglesPerCall = std::uint64_t{1} << 28;
// Colour and depth in the framebuffer, and the colour after it has been read back.
constexpr std::uint64_t kBytesPerSample = 4 + 4 + 4;

void check_options(const RenderOptions& o) {
  if (o.width < 1 || o.height < 1 || o.width > kMaxPictureSide || o.height > kMaxPictureSide) {
    throw InvalidInput(fmt::format("a picture of {} x {} pixels; a side may have 1 to {}", o.width,
                                   o.height, kMaxPictureSide));
  }
  if (o.samples_per_axis < 1 || o.samples_per_axis > kMostSamplesPerAxis) {
    throw InvalidInput(fmt::format("{} samples per axis of a pixel; 1 to {} are possible",
                                   o.samples_per_axis, kMostSamplesPerAxis));
  }
  if (!(o.margin >= 0 && o.margin < 0.5)) {
    throw InvalidInput(fmt::format("a margin of {} of the picture; needs 0 to 0.5", o.margin));
  }
  if (!(norm(o.light) > 0) || !std::isfinite(norm(o.light))) {
    throw InvalidInput("the light needs a finite direction other than zero");
  }
}

// The size of a picture, in samples: samples_per_axis for every pixel along each axis.
struct Size {
  int width, height;
};

// Throws LimitExceeded if the buffers and the samples need more than `limit` bytes.
void check_memory(const MeshSource& source, const Size& samples, std::uint64_t limit) {
  const auto pixels =
      static_cast<std::uint64_t>(samples.width) * static_cast<std::uint64_t>(samples.height);
  const std::uint64_t needed = buffer_bytes(source) + kBytesPerSample * pixels;
  if (needed <= limit) return;
  throw LimitExceeded(fmt::format(
      "a picture of {} triangles with {} x {} samples needs {} bytes, the limit is {}; a coarser "
      "mesh, a smaller picture or fewer samples per pixel need less",
      source.triangle_count(), samples.width, samples.height, needed, limit));
}

// Throws LimitExceeded if the OpenGL device cannot draw so many samples. The context must be
// current.
void check_device(const Size& samples) {
  GLint renderbuffer = 0, viewport[2] = {0, 0};
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &renderbuffer);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
  const int width = std::min(renderbuffer, viewport[0]);
  const int height = std::min(renderbuffer, viewport[1]);
  if (samples.width <= width && samples.height <= height) return;
  throw LimitExceeded(fmt::format(
      "{} x {} samples, and the OpenGL device draws {} x {}; a smaller picture or fewer samples "
      "per pixel would do",
      samples.width, samples.height, width, height));
}

// The framebuffer into which samples are drawn: 8-bit colour and float depth. It stays bound.
class Canvas {
 public:
  explicit Canvas(const Size& size) {
    attach(color_, GL_RGBA8, GL_COLOR_ATTACHMENT0, size);
    attach(depth_, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT, size);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      throw Error("the OpenGL device cannot draw into 8-bit colour with float depth");
    }
  }

 private:
  void attach(const GlObject& buffer, GLenum format, GLenum place, const Size& size) const {
    glBindFramebuffer(GL_FRAMEBUFFER, frame_.name());
    glBindRenderbuffer(GL_RENDERBUFFER, buffer.name());
    glRenderbufferStorage(GL_RENDERBUFFER, format, size.width, size.height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, place, GL_RENDERBUFFER, buffer.name());
    check_gl("the picture");
  }
  GlObject frame_{GlKind::framebuffer};
  GlObject color_{GlKind::renderbuffer}, depth_{GlKind::renderbuffer};
};

// Uploads a colour map as a texture of one row and binds it to texture unit 0.
void bind_palette(const GlObject& texture, ColorMap map) {
  std::array<std::array<std::uint8_t, 3>, kPaletteSize> colors{};
  for (int i = 0; i < kPaletteSize; ++i) {
    colors[static_cast<std::size_t>(i)] = to_bytes(color_at(map, i / double(kPaletteSize - 1)));
  }
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, kPaletteSize, 1, 0, GL_RGB, GL_UNSIGNED_BYTE,
               colors.data());
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) {
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  }
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) {
    glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  }
  check_gl("the palette");
}

// Draws all triangles of the bound buffers, in several calls if there are too many for one call.
// The program needs the index of the first triangle of each call to fetch the values of triangles,
// because OpenGL counts primitives from 0 in every call.
void draw_triangles(const SurfaceProgram& program, std::uint64_t count) {
  for (std::uint64_t first = 0; first < count; first += kTrianglesPerCall) {
    const std::uint64_t here = std::min(count - first, kTrianglesPerCall);
    program.set_first_triangle(first);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * here), GL_UNSIGNED_INT,
                   buffer_offset(first * sizeof(Triangle)));
  }
}

// Draws the surface into the bound framebuffer. Faces are not culled, so that the inside of an open
// surface is visible. The cleared samples have alpha 0, which marks them as not covered.
void draw_surface(const MeshSource& source, const RenderOptions& options, const Camera& camera,
                  const Size& size) {
  const SurfaceBuffers buffers(source, camera.origin);
  const SurfaceProgram program(options.shading);
  const GlObject palette(GlKind::texture);
  if (source.scale()) bind_palette(palette, source.scale()->map);
  glViewport(0, 0, size.width, size.height);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  program.use(camera, options, source.paint(), source.scale());
  buffers.bind();
  draw_triangles(program, source.triangle_count());
  check_gl("the drawing");
}

// Reads the samples from the bound framebuffer.
PixelSamples read_back(const Size& size, int per_axis) {
  PixelSamples samples{size.width, size.height, per_axis, {}};
  samples.values.resize(static_cast<std::size_t>(size.width) *
                        static_cast<std::size_t>(size.height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size.width, size.height, GL_RGBA, GL_UNSIGNED_BYTE, samples.values.data());
  check_gl("reading the picture");
  return samples;
}

// Throws InvalidInput if no sample is covered: an empty picture would be mistaken for a result.
void require_something(const PixelSamples& samples) {
  const auto covered = [](const Rgba8& v) { return v[3] != 0; };
  if (std::ranges::any_of(samples.values, covered)) return;
  throw InvalidInput(
      "no pixel of the picture is covered: the mesh is too thin from this side; choose another "
      "view or a larger picture");
}

// Height in pixels of the part of the picture above the colour bar.
int surface_height(const MeshSource& source, const RenderOptions& options) {
  if (!source.scale()) return options.height;
  return options.height - legend_height(options.width, options.height);
}

}  // namespace

Renderer::Renderer() : context_(std::make_shared<EglContext>()) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;

const std::string& Renderer::device() const { return context_->device(); }

Picture Renderer::draw(const MeshSource& source, const RenderOptions& options) const {
  check_options(options);
  const int height = surface_height(source, options);
  const Size size{options.width * options.samples_per_axis, height * options.samples_per_axis};
  check_memory(source, size, options.memory_limit);
  const Camera camera = frame_surface(source, options.view, options.projection,
                                      static_cast<double>(options.width) / height, options.margin);
  const EglContext::Use use(*context_);
  check_device(size);
  const Canvas canvas(size);
  draw_surface(source, options, camera, size);
  const PixelSamples samples = read_back(size, options.samples_per_axis);
  require_something(samples);
  Picture picture{options.width, options.height, {}};
  picture.pixels.resize(static_cast<std::size_t>(options.width) *
                        static_cast<std::size_t>(options.height));
  resolve(samples, options.background, picture);
  if (source.scale()) draw_legend(*source.scale(), height, options.background, picture);
  return picture;
}

}  // namespace vdwmesh
