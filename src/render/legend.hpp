// The colour bar at the foot of a picture.
#pragma once

#include <optional>

#include "render/color_scale.hpp"
#include "render/picture.hpp"

namespace vdwmesh {

// Rows it takes, in pixels. Throws InvalidInput for a picture too small to hold a readable one.
int legend_height(int picture_width, int picture_height);

// Fills the rows from `top` on: the scale's title, the bar, and labels at round values.
void draw_legend(const ColorScale& scale, int top, const std::optional<Rgb>& background,
                 Picture& picture);

}  // namespace vdwmesh
