// From the samples that OpenGL drew to the pixels of a picture.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/color_map.hpp"
#include "render/picture.hpp"

namespace vdwmesh {

// Covered samples have alpha 255, the others 0. Rows from the bottom, as OpenGL reads them.
struct Samples {
  int width = 0, height = 0;  // of the samples: those of the picture times per_axis
  int per_axis = 1;
  std::vector<Rgba8> values;
};

// Means over per_axis × per_axis samples in linear light, over the background, or with the covered
// share as alpha where there is none. Written to the top of `picture`, which is as wide.
void resolve(const Samples& samples, const std::optional<Rgb>& background, Picture& picture);

// Light from 0 to 1 of an sRGB channel, and the nearest byte of such a light.
double to_linear(double channel);
std::uint8_t to_srgb_byte(double light);

}  // namespace vdwmesh
