// Draws one picture with OpenGL, from checks to pixels.
//
// Steps: (1) check options and memory; (2) frame the surface (camera.cpp); (3) draw it into a
// framebuffer that has samples_per_axis samples along each axis of a pixel (surface_buffers.cpp,
// surface_program.cpp, canvas.cpp), layer by layer from the front if it is transparent; (4) read
// the samples back, find the outline (outline.cpp), and add them to the pixels (samples.cpp); (5)
// add the colour bar (legend.cpp). Averaging is done here and not by OpenGL's multisampling, whose
// sample positions depend on the driver.
#include "render/renderer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "render/opengl/canvas.hpp"
#include "render/opengl/egl_context.hpp"
#include "render/opengl/legend.hpp"
#include "render/opengl/samples.hpp"
#include "render/opengl/surface_buffers.hpp"
#include "render/opengl/surface_program.hpp"
#include "render/outline.hpp"

namespace vdwmesh {
namespace {

// Colours in the texture of a colour map; OpenGL interpolates between them.
constexpr int kPaletteSize = 256;
constexpr int kMostSamplesPerAxis = 8;
// The most triangles in one draw call: their 3 · 2^28 indices are counted in a GLsizei, whose
// largest value is 2^31 - 1.
constexpr std::uint64_t kTrianglesPerCall = std::uint64_t{1} << 28;
// Colour and depth in the framebuffer, and the colour after it has been read back; the depths of
// the layer in front; and the depths that have been read back, with a mark for the outline.
constexpr std::uint64_t kBytesPerSample = 4 + 4 + 4, kBytesOfLayers = 4, kBytesOfOutline = 4 + 1;
// Layers end when less than this share of what is behind them would be seen: less than the step
// from black to the next byte of sRGB.
constexpr double kLeastShare = 1.0 / 4096;
// A line is drawn where the surface ends in front of what is farther by this share of its depth.
constexpr double kOutlineJump = 0.03;

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
  if (!(o.opacity > 0 && o.opacity <= 1)) {
    throw InvalidInput(fmt::format("an opacity of {}; needs more than 0, up to 1", o.opacity));
  }
  if (!(o.outline >= 0 && o.outline < 0.5)) {
    throw InvalidInput(fmt::format("an outline of {} of the picture; needs 0 to 0.5", o.outline));
  }
  if (!(norm(o.light) > 0) || !std::isfinite(norm(o.light))) {
    throw InvalidInput("the light needs a finite direction other than zero");
  }
}

// The size of a picture, in samples: samples_per_axis for every pixel along each axis.
struct Size {
  int width, height;
};

// Throws LimitExceeded if the buffers, the samples and the pixels need more than the limit.
void check_memory(const MeshSource& source, const Size& samples, const RenderOptions& o) {
  const auto count =
      static_cast<std::uint64_t>(samples.width) * static_cast<std::uint64_t>(samples.height);
  const auto per_pixel = static_cast<std::uint64_t>(o.samples_per_axis * o.samples_per_axis);
  const std::uint64_t per_sample = kBytesPerSample + (o.opacity < 1 ? kBytesOfLayers : 0) +
                                   (o.outline > 0 ? kBytesOfOutline : 0);
  const std::uint64_t limit = o.memory_limit, needed = buffer_bytes(source) + per_sample * count +
                                                       count / per_pixel * sizeof(CoveredPixel);
  if (needed <= limit) return;
  throw LimitExceeded(fmt::format(
      "a picture of {} triangles with {} x {} samples needs {} bytes, the limit is {}; a coarser "
      "mesh, a smaller picture or fewer samples per pixel need less",
      source.triangle_count(), samples.width, samples.height, needed, limit));
}

// Throws LimitExceeded if the OpenGL device cannot draw so many samples. The context must be
// current.
void check_device(const Size& samples) {
  GLint colors = 0, depths = 0, viewport[2] = {0, 0};
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &colors);
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &depths);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
  const int width = std::min({colors, depths, viewport[0]});
  const int height = std::min({colors, depths, viewport[1]});
  if (samples.width <= width && samples.height <= height) return;
  throw LimitExceeded(fmt::format(
      "{} x {} samples, and the OpenGL device draws {} x {}; a smaller picture or fewer samples "
      "per pixel would do",
      samples.width, samples.height, width, height));
}

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

bool has_covered(const PixelSamples& samples) {
  return std::ranges::any_of(samples.values, [](const Rgba8& v) { return v[3] != 0; });
}

// Throws InvalidInput if no sample is covered: an empty picture would be mistaken for a result.
void require_something(const PixelSamples& samples) {
  if (has_covered(samples)) return;
  throw InvalidInput(
      "no pixel of the picture is covered: the mesh is too thin from this side; choose another "
      "view or a larger picture");
}

// Distances from the viewer in Å, from the depths of OpenGL, which are linear in them only in an
// orthographic picture.
DepthMap distances_of(std::vector<float> depths, const Size& size, const Camera& camera) {
  const double n = camera.nearest, f = camera.farthest;
  const bool is_linear = camera.projection == CameraProjection::orthographic;
  for_each_index(depths.size(), [&](std::size_t i) {
    const double depth = depths[i];
    const double distance = is_linear ? n + depth * (f - n) : n * f / (f - depth * (f - n));
    depths[i] = depth < 1 ? static_cast<float>(distance) : std::numeric_limits<float>::infinity();
  });
  return {size.width, size.height, std::move(depths)};
}

// The samples of the outline of the layer in the canvas, 1 for each; empty if there shall be none.
std::vector<std::uint8_t> outline_of(const Canvas& canvas, const Size& size,
                                     const MeshSource& source, const RenderOptions& options,
                                     const Camera& camera) {
  if (!(options.outline > 0)) return {};
  const Vec3d toward_viewer = camera.axes[2];
  const std::array<Vec3d, 2> both{toward_viewer, -1.0 * toward_viewer};
  const std::vector<double> reach = source.support(both);
  const double width =
      options.outline * std::min(options.width, options.height) * options.samples_per_axis;
  return find_outline(distances_of(canvas.read_depths(), size, camera),
                      kOutlineJump * (reach[0] + reach[1]), width / 2);
}

// Gives the samples of the lines one colour, and takes all others away.
void keep_lines(const std::vector<std::uint8_t>& lines, const Rgb& ink, PixelSamples& samples) {
  const auto [r, g, b] = to_bytes(ink);
  const Rgba8 on{r, g, b, 255}, off{0, 0, 0, 0};
  std::ranges::transform(lines, samples.values.begin(),
                         [&](std::uint8_t line) { return line ? on : off; });
}

// Takes the samples of the lines away, which hide the surface.
void leave_out_lines(const std::vector<std::uint8_t>& lines, PixelSamples& samples) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i]) samples.values[i] = {0, 0, 0, 0};
  }
}

// Draws the surface layer by layer, from the front, and adds up the light of each pixel. Faces are
// not culled, so that the inside of an open surface is visible. Of an opaque surface the first
// layer is all there is.
std::vector<CoveredPixel> draw_surface(const MeshSource& source, const RenderOptions& options,
                                       const Camera& camera, const Size& size) {
  Canvas canvas(size.width, size.height);
  const SurfaceBuffers buffers(source, camera.origin);
  const SurfaceProgram program(options);
  const GlObject palette(GlKind::texture);
  if (source.scale()) bind_palette(palette, source.scale()->map);
  glViewport(0, 0, size.width, size.height);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  program.use(camera, options, source.paint(), source.scale());
  buffers.bind();
  const int per_axis = options.samples_per_axis;
  std::vector<CoveredPixel> pixels(static_cast<std::size_t>(size.width / per_axis) *
                                   static_cast<std::size_t>(size.height / per_axis));
  PixelSamples samples{size.width, size.height, per_axis, {}};
  std::vector<std::uint8_t> lines;
  double let_through = 1;
  for (int layer = 0; let_through > kLeastShare; ++layer, let_through *= 1 - options.opacity) {
    canvas.begin_layer();
    program.set_layer(layer);
    draw_triangles(program, source.triangle_count());
    check_gl("the drawing");
    canvas.read_colors(samples);
    if (layer == 0) {
      require_something(samples);
      lines = outline_of(canvas, size, source, options, camera);
    } else if (!has_covered(samples)) {
      break;
    }
    leave_out_lines(lines, samples);
    add_layer(samples, let_through * options.opacity, pixels);
  }
  if (!lines.empty()) {
    keep_lines(lines, ink_on(options.background), samples);
    add_layer(samples, 1, pixels);
  }
  return pixels;
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
  check_memory(source, size, options);
  const Camera camera = frame_surface(source, options.view, options.projection,
                                      static_cast<double>(options.width) / height, options.margin);
  const EglContext::Use use(*context_);
  check_device(size);
  const std::vector<CoveredPixel> pixels = draw_surface(source, options, camera, size);
  Picture picture{options.width, options.height, {}};
  picture.pixels.resize(static_cast<std::size_t>(options.width) *
                        static_cast<std::size_t>(options.height));
  resolve(pixels, options.samples_per_axis * options.samples_per_axis, options.background, picture);
  if (source.scale()) draw_legend(*source.scale(), height, options.background, picture);
  return picture;
}

}  // namespace vdwmesh
