// Which colour a value has, and the labels that say so.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "render/color_map.hpp"

namespace vdwmesh {

// Values from `lower` to `upper` run through the map; values beyond have the colours of its ends.
struct ColorScale {
  ColorMap map = ColorMap::viridis;
  double lower = 0, upper = 1;  // finite, lower < upper
  std::string title;            // of the colour bar, with the unit
};

// Throws InvalidInput where the bounds are not finite or not in order.
void check(const ColorScale& scale);

// Bounds that hold the share `inside` of the finite values, rounded outwards to two digits: about
// 0,
// [-b, b], for a diverging map; and [lower, upper] otherwise. Without two different values the
// bounds are 1e-3 apart at least. Throws InvalidInput where no value is finite.
enum class ScaleKind { symmetric, one_sided };
ColorScale fit_scale(ColorMap map, ScaleKind kind, std::span<const float> values, double inside,
                     std::string title);

// Values in [lower, upper] that are multiples of a round step (1, 2 or 5 times a power of ten):
// `most` at most, and two at least where `most` is 7 or more. Their text has as many decimals as
// the step; a minus is U+2212.
struct Tick {
  double value;
  std::string label;
};
std::vector<Tick> ticks(const ColorScale& scale, int most);

}  // namespace vdwmesh
