// A picture in memory and as a PNG file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace vdwmesh {

using Rgba8 = std::array<std::uint8_t, 4>;  // sRGB and straight alpha: 255 is opaque

// A picture. Rows run from the top, pixels of a row from the left.
struct Picture {
  int width = 0, height = 0;  // pixels
  std::vector<Rgba8> pixels;  // width * height

  Rgba8& at(int x, int y) { return pixels[index(x, y)]; }
  const Rgba8& at(int x, int y) const { return pixels[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

// Returns the bytes of a PNG file with 8 bits per channel: RGB if every pixel is opaque, else RGBA.
// The same picture gives the same bytes. Throws InvalidInput for a picture without pixels, and
// BackendUnavailable in a build without libpng.
std::string encode_png(const Picture& picture);

}  // namespace vdwmesh
