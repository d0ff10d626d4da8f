// Averages the samples of each pixel with equal weights (a box filter) in linear light. Averages of
// encoded sRGB values would make edges too dark. The rows of the picture are computed in parallel.
#include "render/opengl/samples.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

// Linear light of each sRGB byte (IEC 61966-2-1), computed once.
const std::array<double, 256>& linear_of_byte() {
  static const auto kTable = [] {
    std::array<double, 256> t{};
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = to_linear(static_cast<double>(i) / 255);
    return t;
  }();
  return kTable;
}

// Adds up the covered samples of one pixel, in column x and in the given row. Rows count from the
// bottom, as in PixelSamples.
CoveredPixel gather(const PixelSamples& s, int x, int y_from_bottom) {
  const std::array<double, 256>& linear = linear_of_byte();
  CoveredPixel covered;
  for (int j = 0; j < s.per_axis; ++j) {
    const auto row = static_cast<std::size_t>(y_from_bottom * s.per_axis + j) *
                     static_cast<std::size_t>(s.width);
    for (int i = 0; i < s.per_axis; ++i) {
      const Rgba8& v = s.values[row + static_cast<std::size_t>(x * s.per_axis + i)];
      // Alpha 0: the sample shows no surface.
      if (v[3] == 0) continue;
      covered.light = covered.light + Vec3d{linear[v[0]], linear[v[1]], linear[v[2]]};
      ++covered.count;
    }
  }
  return covered;
}

// Returns a pixel of a picture without a background. Alpha is straight: the colour is not
// multiplied by it. `samples` is the number of samples of a pixel.
Rgba8 over_nothing(const CoveredPixel& c, int samples) {
  if (c.count == 0) return {0, 0, 0, 0};
  const double n = c.count;
  return {to_srgb_byte(c.light.x / n), to_srgb_byte(c.light.y / n), to_srgb_byte(c.light.z / n),
          static_cast<std::uint8_t>(std::lround(255.0 * n / samples))};
}

// Returns a pixel over a background. Samples that are not covered show the background.
Rgba8 over(const Vec3d& background, const CoveredPixel& c, int samples) {
  const double free = samples - c.count;
  const auto channel = [&](double light, double behind) {
    return to_srgb_byte((light + free * behind) / samples);
  };
  return {channel(c.light.x, background.x), channel(c.light.y, background.y),
          channel(c.light.z, background.z), 255};
}

}  // namespace

double to_linear(double channel) {
  return channel <= 0.04045 ? channel / 12.92 : std::pow((channel + 0.055) / 1.055, 2.4);
}

std::uint8_t to_srgb_byte(double light) {
  const double v = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(v, 0.0, 1.0)));
}

void add_layer(const PixelSamples& samples, double weight, std::span<CoveredPixel> pixels) {
  const int rows = samples.height / samples.per_axis, columns = samples.width / samples.per_axis;
  tbb::parallel_for(0, rows, [&](int y) {
    for (int x = 0; x < columns; ++x) {
      const CoveredPixel covered = gather(samples, x, rows - 1 - y);
      CoveredPixel& pixel = pixels[static_cast<std::size_t>(y * columns + x)];
      pixel.light = pixel.light + weight * covered.light;
      pixel.count += weight * covered.count;
    }
  });
}

void resolve(std::span<const CoveredPixel> pixels, int samples,
             const std::optional<Rgb>& background, Picture& picture) {
  // The samples are bytes, so the background is rounded to bytes too: a pixel without covered
  // samples then has exactly the bytes of the background.
  const auto bytes = to_bytes(background.value_or(Rgb{0, 0, 0}));
  const std::array<double, 256>& linear = linear_of_byte();
  const Vec3d behind{linear[bytes[0]], linear[bytes[1]], linear[bytes[2]]};
  for_each_index(pixels.size(), [&](std::size_t i) {
    picture.pixels[i] =
        background ? over(behind, pixels[i], samples) : over_nothing(pixels[i], samples);
  });
}

}  // namespace vdwmesh
