// Chooses round bounds and round labels for colour scales. A round number is a small factor times a
// power of ten. Rounding errors must not change the choice: a value that exceeds a round number
// only in its last bits still counts as that number (kSlack).
#include "render/color_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

constexpr double kLeastBound = 5e-4;  // the smallest bound, for example of values that are all zero
constexpr double kSlack = 1e-9;       // relative

// Returns the least round number that is at least v, for v > 0. symmetric_bound() in the header
// lists the factors; 10 times the power of ten is the first round number of the next one.
double round_up(double v) {
  constexpr double kRound[] = {1, 1.5, 2, 3, 4, 5, 6, 8};
  const double unit = std::pow(10, std::floor(std::log10(v)));
  for (const double factor : kRound) {
    if (factor * unit >= v * (1 - kSlack)) return factor * unit;
  }
  return 10 * unit;
}

// Returns the smallest of the n values such that at least the share `share` of them is not above
// it: the value of rank ceil(share n), counted from 1. Changes the order of the values.
// Precondition: n > 0.
double quantile(std::vector<double>& values, double share) {
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  const auto at =
      std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(rank) - 1, 0, std::ssize(values) - 1);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

// Returns the sign before the label of a value: "≤ " or "≥ " if the label stands at an end of the
// scale beyond which there are values, else the empty string.
const char* tail_sign(const ColorScale& scale, double value) {
  const double near = kSlack * (scale.upper - scale.lower);
  const bool at_lower = std::abs(value - scale.lower) <= near;
  const bool at_upper = std::abs(value - scale.upper) <= near;
  const bool below = scale.tails == Tails::below || scale.tails == Tails::both;
  const bool above = scale.tails == Tails::above || scale.tails == Tails::both;
  return at_lower && below ? "\u2264 " : at_upper && above ? "\u2265 " : "";
}

}  // namespace

void check(const ColorScale& scale) {
  if (std::isfinite(scale.lower) && std::isfinite(scale.upper) && scale.lower < scale.upper) return;
  throw InvalidInput(
      fmt::format("colour scale from {} to {}: needs two finite numbers, the lower one first",
                  scale.lower, scale.upper));
}

double symmetric_bound(std::span<const float> values, double inside) {
  std::vector<double> sizes;
  sizes.reserve(values.size());
  for (const float v : values) {
    if (std::isfinite(v)) sizes.push_back(std::abs(v));
  }
  if (sizes.empty()) throw InvalidInput("no value to colour by: none of them is finite");
  return round_up(std::max(quantile(sizes, inside), kLeastBound));
}

Tails find_tails(const ColorScale& scale, std::span<const float> values) {
  // A bound may have been computed from the largest or smallest of these floats, with rounding. The
  // slack makes sure that this float does not count as outside.
  const double slack = kSlack * (scale.upper - scale.lower);
  const auto below = [&](float v) { return v < scale.lower - slack; };
  const auto above = [&](float v) { return v > scale.upper + slack; };
  const bool lower = std::ranges::any_of(values, below);
  const bool upper = std::ranges::any_of(values, above);
  return lower && upper ? Tails::both : lower ? Tails::below : upper ? Tails::above : Tails::none;
}

std::vector<Tick> ticks(const ColorScale& scale, int most) {
  check(scale);
  // `raw`, the step that would give `most` ticks exactly, is rounded up to 1, 2, 5 or 10 times a
  // power of ten. The exponent `power` gives the number of decimals; a factor of 10 needs one
  // decimal less. If `raw` is a power of ten, rounding may give a logarithm a little below its
  // whole exponent; 1e-12 prevents that std::floor() then takes the next lower exponent.
  const double raw = (scale.upper - scale.lower) / std::max(most - 1, 1);
  const double power = std::floor(std::log10(raw) + 1e-12);
  const double unit = std::pow(10, power), mantissa = raw / unit;
  const double factor = mantissa <= 1 + kSlack   ? 1
                        : mantissa <= 2 + kSlack ? 2
                        : mantissa <= 5 + kSlack ? 5
                                                 : 10;
  const double step = factor * unit;
  const int decimals = std::max(0, static_cast<int>(-power) - (factor == 10 ? 1 : 0));
  std::vector<Tick> result;
  // The ticks are i * step for i from `first` to `last`. U+2212 is the minus sign.
  const auto first = std::llround(std::ceil(scale.lower / step - kSlack));
  const auto last = std::llround(std::floor(scale.upper / step + kSlack));
  for (auto i = first; i <= last; ++i) {
    const double value = static_cast<double>(i) * step;
    result.push_back({value, fmt::format("{}{}{:.{}f}", tail_sign(scale, value),
                                         i < 0 ? "\u2212" : "", std::abs(value), decimals)});
  }
  return result;
}

}  // namespace vdwmesh
