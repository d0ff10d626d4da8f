// Which colour a value has, and the labels that say so.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "render/color_map.hpp"

namespace vdwmesh {

// On which sides values lie outside of the bounds; they have the colours of the ends, and labels
// say so.
enum class Tails { none, below, above, both };

// Values from `lower` to `upper` run through the map.
struct ColorScale {
  ColorMap map = ColorMap::viridis;
  double lower = 0, upper = 1;  // finite, lower < upper
  std::string title;            // of the colour bar, with the unit
  Tails tails = Tails::none;
};

// Throws InvalidInput where the bounds are not finite or not in order.
void check(const ColorScale& scale);

// The bound b, round (1, 1.5, 2, 3, 4, 5, 6 or 8 times a power of ten), for which [-b, b] holds at
// least the share `inside` of the finite values; at least 5e-4. Throws InvalidInput where no value
// is finite.
double symmetric_bound(std::span<const float> values, double inside);

// On which sides values lie outside of the bounds.
Tails find_tails(const ColorScale& scale, std::span<const float> values);

// Values in [lower, upper] that are multiples of a round step (1, 2 or 5 times a power of ten):
// `most` at most, and two at least where `most` is 7 or more. Their text has as many decimals as
// the step; a minus is U+2212.
struct Tick {
  double value;
  std::string label;
};
std::vector<Tick> ticks(const ColorScale& scale, int most);

}  // namespace vdwmesh
