// Colour maps that people with colour-blindness can read.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace vdwmesh {

// A colour in sRGB, gamma-encoded as screens and picture files take it; each channel is in [0, 1].
struct Rgb {
  float r, g, b;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

// Returns the nearest byte to 255 times a channel, or three of them; channels are first clamped to
// [0, 1].
inline std::uint8_t to_byte(float channel) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(channel, 0.0f, 1.0f)));
}
inline std::array<std::uint8_t, 3> to_bytes(const Rgb& color) {
  return {to_byte(color.r), to_byte(color.g), to_byte(color.b)};
}

enum class ColorMap {
  viridis,  // sequential, dark violet to yellow (Smith and van der Walt 2015)
  cividis,  // sequential, dark blue to yellow, the same for red-green blindness (Nuñez et al. 2018)
  cool_warm,  // diverging, blue over grey to red; neutral at 1/2 (Moreland 2009)
};

// Returns the colour of the map at t in [0, 1]; t outside gives the colour of the nearer end. In
// the sequential maps lightness rises with t. cool_warm is a light neutral grey at t = 1/2 and
// darkens equally to both sides. Throws InvalidInput for NaN.
Rgb color_at(ColorMap map, double t);

}  // namespace vdwmesh
