// Draws the legend (title, colour bar, tick marks and labels, from top to bottom) into the lowest
// rows of a picture, after OpenGL has drawn the surface into the rows above it.
//
// All heights are multiples of the text size, in pixels per em, which grows with the picture. There
// are as many labels as possible without neighbours that come too close (fitting_ticks()).
#include "render/opengl/legend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "render/opengl/samples.hpp"
#include "render/opengl/text.hpp"

namespace vdwmesh {
namespace {

// The smallest picture that has a legend, in pixels.
constexpr int kLeastWidth = 240, kLeastHeight = 160;
// Pixels per em; smaller text is not readable.
constexpr int kLeastTextSize = 11;
constexpr double kBarShare = 0.62;  // the bar's width as a share of the picture's

// Pixels per em for a picture of this size.
int text_size(int width, int height) {
  return std::max(kLeastTextSize, std::min(width / 48, height / 36));
}

// Heights below the top of the legend, in text sizes.
constexpr double kTitleBaseline = 0.9, kBarTop = 1.4, kBarBottom = 2.3, kTickBottom = 2.55,
                 kLabelBaseline = 3.55, kHeight = 4.2;

// Converts a height in text sizes to rows of pixels; `size` is the text size in pixels.
int rows(double text_sizes, int size) { return static_cast<int>(std::lround(text_sizes * size)); }

// Pixels of a picture: columns [left, right) and rows [top, bottom).
struct Rectangle {
  int left, right, top, bottom;
};

void fill(const Rectangle& r, const Rgb& color, Picture& picture) {
  for (int y = r.top; y < r.bottom; ++y) {
    for (int x = r.left; x < r.right; ++x) blend(color, 1, picture.at(x, y));
  }
}

// Draws the bar, one colour per column of pixels, with a frame that is one pixel wide.
void draw_bar(const ColorScale& scale, const Rectangle& bar, const Rgb& ink, Picture& picture) {
  fill({bar.left - 1, bar.right + 1, bar.top - 1, bar.bottom + 1}, ink, picture);
  const double width = bar.right - bar.left;
  for (int x = bar.left; x < bar.right; ++x) {
    fill({x, x + 1, bar.top, bar.bottom}, color_at(scale.map, (x - bar.left + 0.5) / width),
         picture);
  }
}

// Returns the column of pixels at which a value stands on the bar: `lower` of the scale is at the
// first column of the bar, `upper` at the last.
int place(const ColorScale& scale, const Rectangle& bar, double value) {
  const double share = (value - scale.lower) / (scale.upper - scale.lower);
  return bar.left + static_cast<int>(std::lround(share * (bar.right - 1 - bar.left)));
}

// Returns the ticks to be labelled: as many as possible, 11 at most, such that half the width of
// the widest label is free between neighbours. Labels are centred at their ticks, so neighbouring
// ticks must be 1.5 widths apart; ticks have equal distances, so the first two decide. The limit
// falls from 11 to 3 until the ticks fit; the ticks for 3 are returned even if they do not fit.
std::vector<Tick> fitting_ticks(const ColorScale& scale, const Rectangle& bar, const Font& font) {
  std::vector<Tick> chosen;
  for (int most = 11; most >= 3; most -= 2) {
    chosen = ticks(scale, most);
    int widest = 0;
    for (const Tick& tick : chosen) widest = std::max(widest, font.width(tick.label));
    const bool alone = chosen.size() < 2;
    const int apart =
        alone ? 0 : place(scale, bar, chosen[1].value) - place(scale, bar, chosen[0].value);
    if (alone || 2 * apart >= 3 * widest) break;
  }
  return chosen;
}

void draw_ticks(const ColorScale& scale, const Rectangle& bar, const Font& font, int size, int top,
                const Rgb& ink, Picture& picture) {
  for (const Tick& tick : fitting_ticks(scale, bar, font)) {
    const int x = place(scale, bar, tick.value);
    fill({x, x + std::max(1, size / 14), bar.bottom, top + rows(kTickBottom, size)}, ink, picture);
    font.draw(tick.label, x - font.width(tick.label) / 2, top + rows(kLabelBaseline, size), ink,
              picture);
  }
}

}  // namespace

Rgb ink_on(const std::optional<Rgb>& background) {
  if (!background) return {0, 0, 0};
  const double luminance = 0.2126 * to_linear(background->r) + 0.7152 * to_linear(background->g) +
                           0.0722 * to_linear(background->b);
  return luminance > 0.18 ? Rgb{0, 0, 0} : Rgb{1, 1, 1};
}

int legend_height(int picture_width, int picture_height) {
  if (picture_width < kLeastWidth || picture_height < kLeastHeight) {
    throw InvalidInput(fmt::format(
        "a picture of {} x {} pixels is too small for a colour bar; at least {} x {} are needed",
        picture_width, picture_height, kLeastWidth, kLeastHeight));
  }
  return rows(kHeight, text_size(picture_width, picture_height));
}

void draw_legend(const ColorScale& scale, int top, const std::optional<Rgb>& background,
                 Picture& picture) {
  const int size = text_size(picture.width, picture.height);
  const Rgb ink = ink_on(background);
  const Rgb paper = background.value_or(Rgb{0, 0, 0});
  const Rgba8 blank = {to_bytes(paper)[0], to_bytes(paper)[1], to_bytes(paper)[2],
                       static_cast<std::uint8_t>(background ? 255 : 0)};
  std::fill(picture.pixels.begin() + std::ptrdiff_t{top} * picture.width, picture.pixels.end(),
            blank);
  const Font font(size);
  const int half = static_cast<int>(kBarShare * picture.width / 2), middle = picture.width / 2;
  const Rectangle bar{middle - half, middle + half, top + rows(kBarTop, size),
                      top + rows(kBarBottom, size)};
  font.draw(scale.title, middle - font.width(scale.title) / 2, top + rows(kTitleBaseline, size),
            ink, picture);
  draw_bar(scale, bar, ink, picture);
  draw_ticks(scale, bar, font, size, top, ink, picture);
}

}  // namespace vdwmesh
