// Makes the pixels of a picture from the samples that OpenGL has drawn.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

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

// Computes each pixel as the mean of its per_axis × per_axis samples, in linear light. Samples
// that are not covered count as background. Without a background, a pixel has the mean colour of
// its covered samples, and their share as alpha. The pixels go to the top rows of `picture`, which
// must be samples.width / per_axis pixels wide.
void resolve(const PixelSamples& samples, const std::optional<Rgb>& background, Picture& picture);

// Converts an sRGB channel to linear light, both from 0 to 1.
double to_linear(double channel);
// Converts linear light, clamped to [0, 1], to the nearest sRGB byte.
std::uint8_t to_srgb_byte(double light);

}  // namespace vdwmesh
