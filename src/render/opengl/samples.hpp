// Makes the pixels of a picture from the samples that OpenGL has drawn.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/vec3.hpp"
#include "render/color_map.hpp"
#include "render/picture.hpp"

namespace vdwmesh {

// The samples of a picture, in rows from the bottom as OpenGL reads them. Samples that show
// the surface have alpha 255, all others 0.
struct PixelSamples {
  // In samples: the picture's size in pixels times per_axis.
  int width = 0, height = 0;
  int per_axis = 1;
  std::vector<Rgba8> values;
};

// What the layers of a surface do to the samples of one pixel: the sum of the linear light that
// they send, and how many samples they hide of what is behind.
struct CoveredPixel {
  Vec3d light{};  // red, green, blue
  double count = 0;
};

// Adds a layer to the pixels, which stand in rows from the top: a covered sample adds the share
// `weight` of its light, and hides as much of what is behind. Layers come from front to back, so a
// layer that is covered by others has what these let through as its weight, times its opacity.
void add_layer(const PixelSamples& samples, double weight, std::span<CoveredPixel> pixels);

// Computes each pixel as the mean of its samples, in linear light; `samples` is their number. What
// is not hidden shows the background. Without a background, a pixel has the mean colour of what is
// covered, and its share as alpha. The pixels go to the top rows of `picture`.
void resolve(std::span<const CoveredPixel> pixels, int samples,
             const std::optional<Rgb>& background, Picture& picture);

// Converts an sRGB channel to linear light, both from 0 to 1.
double to_linear(double channel);
// Converts linear light, clamped to [0, 1], to the nearest sRGB byte.
std::uint8_t to_srgb_byte(double light);

}  // namespace vdwmesh
