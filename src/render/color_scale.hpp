// Which colour a value has, and which numbers label a colour bar.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "render/color_map.hpp"

namespace vdwmesh {

// On which sides of a scale there are values outside its bounds. Such values are drawn in the
// colour of the nearer bound, and the label of that bound has the sign "≤" or "≥".
enum class Tails { none, below, above, both };

// Maps the values from `lower` to `upper` linearly to the colours of a colour map.
struct ColorScale {
  ColorMap map = ColorMap::viridis;
  // Finite, and lower < upper. In the unit of the values.
  double lower = 0, upper = 1;
  // Of the colour bar, with the unit.
  std::string title;
  Tails tails = Tails::none;
};

// Throws InvalidInput if the bounds are not finite or not in order.
void check(const ColorScale& scale);

// Returns the least round b such that [-b, b] contains at least the share `inside` of the finite
// values; `inside` is from 0 to 1.
// Round numbers are 1, 1.5, 2, 3, 4, 5, 6 or 8 times a power of ten. The result is at least 5e-4.
// Throws InvalidInput if no value is finite.
double symmetric_bound(std::span<const float> values, double inside);

// Returns on which sides of the scale some of the values lie outside its bounds. NaN is on neither.
Tails find_tails(const ColorScale& scale, std::span<const float> values);

// A labelled value of a colour bar. The label has as many decimals as the step between ticks; its
// minus sign is U+2212.
struct Tick {
  double value;
  std::string label;
};
// Returns the multiples of a round step that lie in [lower, upper]. The step is the least number of
// the form 1, 2 or 5 times a power of ten that cannot give more than `most` ticks. If `most` is 7
// or more, there are at least two ticks.
std::vector<Tick> ticks(const ColorScale& scale, int most);

}  // namespace vdwmesh
