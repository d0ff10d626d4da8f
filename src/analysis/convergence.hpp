// How fast a sequence of approximations approaches its limit, and where that limit lies.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace vdwmesh {

// |error| = scale * size^order.
struct PowerLaw {
  double order, scale;
  double rms_residual;  // of ln |error|
  std::size_t points;   // that took part
};

// Least squares on (ln size, ln |error|). Errors that are exactly 0, which have no logarithm, or
// not finite are left out; nothing where fewer than two different sizes remain. Throws InvalidInput
// for spans of different lengths, or a size that is not finite and positive.
std::optional<PowerLaw> fit_power_law(std::span<const double> sizes,
                                      std::span<const double> errors);

// value(size) = limit + constant * size^order.
struct Extrapolation {
  double limit, order;
};

inline constexpr double kMinExtrapolationOrder = 0.05;
inline constexpr double kMaxExtrapolationOrder = 16;

// Richardson's extrapolation with the order that the values themselves show (L. F. Richardson and
// J. A. Gaunt, Phil. Trans. R. Soc. A 226 (1927) 299; for steps of any ratio I. B. Celik et al.,
// J. Fluids Eng. 130 (2008) 078001): the curve through the values of the three smallest sizes,
// which need not be in order. Nothing where there are fewer than three different sizes, or where
// the values do not approach a limit with an order between the bounds above. Throws as
// fit_power_law().
std::optional<Extrapolation> extrapolate(std::span<const double> sizes,
                                         std::span<const double> values);

}  // namespace vdwmesh
