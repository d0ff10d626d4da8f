#include "render/color_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

constexpr double kLeastWidth = 1e-3;  // of a scale whose values are all alike

// `v` to two digits, away from zero (direction > 0) or, on either side of it, up (1) or down (-1).
double round_to_two_digits(double v, double (*round)(double)) {
  if (v == 0) return 0;
  const double unit = std::pow(10, std::floor(std::log10(std::abs(v))) - 1);
  constexpr double kSlack = 1e-9;  // what is round but for the last bits stays
  const double digits = v / unit;
  const double nearest = std::round(digits);
  return unit * (std::abs(digits - nearest) < kSlack ? nearest : round(digits));
}

// The value of rank ceil(share n), n >= 1.
double quantile(std::vector<double>& values, double share) {
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  const auto at =
      std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(rank) - 1, 0, std::ssize(values) - 1);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

double up(double v) { return round_to_two_digits(v, std::ceil); }
double down(double v) { return round_to_two_digits(v, std::floor); }

}  // namespace

void check(const ColorScale& scale) {
  if (std::isfinite(scale.lower) && std::isfinite(scale.upper) && scale.lower < scale.upper) return;
  throw InvalidInput(
      fmt::format("colour scale from {} to {}: needs two finite numbers, the lower one first",
                  scale.lower, scale.upper));
}

ColorScale fit_scale(ColorMap map, ScaleKind kind, std::span<const float> values, double inside,
                     std::string title) {
  std::vector<double> finite;
  finite.reserve(values.size());
  for (const float v : values) {
    if (std::isfinite(v)) finite.push_back(kind == ScaleKind::symmetric ? std::abs(v) : v);
  }
  if (finite.empty()) throw InvalidInput("no value to colour by: none of them is finite");
  ColorScale scale{map, 0, 0, std::move(title)};
  if (kind == ScaleKind::symmetric) {
    scale.upper = std::max(up(quantile(finite, inside)), kLeastWidth / 2);
    scale.lower = -scale.upper;
  } else {
    scale.upper = up(quantile(finite, (1 + inside) / 2));
    scale.lower = down(quantile(finite, (1 - inside) / 2));
    if (!(scale.upper - scale.lower >= kLeastWidth)) scale.upper = scale.lower + kLeastWidth;
  }
  check(scale);
  return scale;
}

std::vector<Tick> ticks(const ColorScale& scale, int most) {
  check(scale);
  const double raw = (scale.upper - scale.lower) / std::max(most - 1, 1);
  const double power = std::floor(std::log10(raw) + 1e-12);
  const double unit = std::pow(10, power), mantissa = raw / unit;
  constexpr double kSlack = 1e-9;  // relative; what is round but for the last bits stays
  const double factor = mantissa <= 1 + kSlack   ? 1
                        : mantissa <= 2 + kSlack ? 2
                        : mantissa <= 5 + kSlack ? 5
                                                 : 10;
  const double step = factor * unit;
  const int decimals = std::max(0, static_cast<int>(-power) - (factor == 10 ? 1 : 0));
  std::vector<Tick> result;
  const auto first = std::llround(std::ceil(scale.lower / step - kSlack));
  const auto last = std::llround(std::floor(scale.upper / step + kSlack));
  for (auto i = first; i <= last; ++i) {
    const double value = static_cast<double>(i) * step;
    result.push_back(
        {value, fmt::format("{}{:.{}f}", i < 0 ? "\u2212" : "", std::abs(value), decimals)});
  }
  return result;
}

}  // namespace vdwmesh
