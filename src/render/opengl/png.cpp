// Encodes pictures as PNG with libpng's simplified API, which writes to memory. The alpha channel
// is dropped if all pixels are opaque.
#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <vector>

#include "core/errors.hpp"
#include "render/picture.hpp"

namespace vdwmesh {
namespace {

// The pixels as RGB bytes.
std::vector<std::uint8_t> without_alpha(const Picture& picture) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(3 * picture.pixels.size());
  for (const Rgba8& pixel : picture.pixels)
    bytes.insert(bytes.end(), pixel.begin(), pixel.end() - 1);
  return bytes;
}

std::string encode(png_image& image, const void* pixels) {
  png_alloc_size_t size = 0;
  std::string bytes;
  // Without a buffer the call only computes the size of the file; the second call writes it.
  if (png_image_write_to_memory(&image, nullptr, &size, 0, pixels, 0, nullptr)) {
    bytes.resize(size);
    png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels, 0, nullptr);
  }
  if (PNG_IMAGE_FAILED(image)) throw Error(fmt::format("libpng: {}", image.message));
  bytes.resize(size);
  return bytes;
}

}  // namespace

std::string encode_png(const Picture& picture) {
  if (picture.width < 1 || picture.height < 1) throw InvalidInput("a picture without pixels");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  const auto opaque = [](const Rgba8& pixel) { return pixel[3] == 255; };
  if (std::ranges::all_of(picture.pixels, opaque)) {
    image.format = PNG_FORMAT_RGB;
    return encode(image, without_alpha(picture).data());
  }
  image.format = PNG_FORMAT_RGBA;
  return encode(image, picture.pixels.data());
}

}  // namespace vdwmesh
