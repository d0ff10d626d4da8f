// Text in pictures: DejaVu Sans, which is part of the program.
#pragma once

#include <memory>
#include <string_view>

#include "render/color_map.hpp"
#include "render/picture.hpp"

namespace vdwmesh {

class Font {
 public:
  // `size`: pixels per em.
  explicit Font(int size);
  ~Font();
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;

  // Pixels that a line of UTF-8 text advances.
  int width(std::string_view text) const;
  // Draws it with its left end at x and its baseline at row y; what lies outside is cut off.
  void draw(std::string_view text, int x, int y, const Rgb& ink, Picture& picture) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Puts `ink` over a pixel, covering the share `coverage` of it, 0 to 1.
void blend(const Rgb& ink, double coverage, Rgba8& pixel);

}  // namespace vdwmesh
