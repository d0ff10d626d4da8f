// Text in pictures. The font is DejaVu Sans, whose file is embedded in the program.
#pragma once

#include <memory>
#include <string_view>

#include "render/color_map.hpp"
#include "render/picture.hpp"

namespace vdwmesh {

struct FontFace;  // FreeType's, in text.cpp

// The font in one size, as FreeType renders it.
class Font {
 public:
  // `size`: pixels per em.
  explicit Font(int size);
  ~Font();
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;

  // Width of a line of UTF-8 text: the pixels by which it advances.
  int width(std::string_view text) const;
  // Draws a line of UTF-8 text. Its left end is at column x and its baseline at row y. Whatever
  // lies outside the picture is cut off.
  void draw(std::string_view text, int x, int y, const Rgb& ink, Picture& picture) const;

 private:
  std::unique_ptr<FontFace> face_;
};

// Blends `ink` over a pixel in linear light; `coverage`, from 0 to 1, is the covered share of the
// pixel.
void blend(const Rgb& ink, double coverage, Rgba8& pixel);

}  // namespace vdwmesh
