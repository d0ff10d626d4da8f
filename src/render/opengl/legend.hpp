// The colour bar at the foot of a picture.
#pragma once

#include <optional>

#include "render/color_scale.hpp"
#include "render/picture.hpp"

namespace vdwmesh {

// The height of the legend in rows of pixels. Throws InvalidInput if the picture is too small for a
// readable legend.
int legend_height(int picture_width, int picture_height);

// The colour of text and lines: black on a light background, white on a dark one. A background is
// light if its relative luminance (CIE Y of sRGB, computed in linear light) exceeds 0.18, the
// luminance of middle grey. On a transparent background (no value) they are black.
Rgb ink_on(const std::optional<Rgb>& background);

// Fills the rows from `top` to the foot of the picture with the scale's title, the bar, and labels
// at round values. The rows are cleared to `background` before, or to transparent if there is none.
void draw_legend(const ColorScale& scale, int top, const std::optional<Rgb>& background,
                 Picture& picture);

}  // namespace vdwmesh
