// Order of convergence of a sequence of approximations, and extrapolation to its limit.
//
// A sequence consists of sizes (grid spacing, edge length or number of triangles, any unit) and one
// error or value for each size. A study applies both functions to its runs (study.hpp).
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace vdwmesh {

// The model |error| = scale * size^order.
struct PowerLaw {
  double order, scale;
  double rms_residual;  // root mean square of the residuals of ln |error|
  std::size_t points;   // how many points were used in the fit
};

// Fits a power law by least squares on (ln size, ln |error|). Errors that are exactly 0 have no
// logarithm; they are left out, and so are errors that are not finite. The result is empty if fewer
// than two different sizes remain. Throws InvalidInput if the spans have different lengths, or if a
// size is not finite and positive.
std::optional<PowerLaw> fit_power_law(std::span<const double> sizes,
                                      std::span<const double> errors);

// The model value(size) = limit + constant * size^order.
struct Extrapolation {
  double limit, order;
};

// The range of orders in which extrapolate() searches.
inline constexpr double kMinExtrapolationOrder = 0.05;
inline constexpr double kMaxExtrapolationOrder = 16;

// Richardson extrapolation with an observed order (L. F. Richardson and J. A. Gaunt, Phil. Trans.
// R. Soc. A 226 (1927) 299; for sizes of any ratio I. B. Celik et al., J. Fluids Eng. 130 (2008)
// 078001). The three parameters of the model (limit, constant, order) are chosen so that it passes
// through the finite values at the three smallest sizes that have one. The sizes may be in any
// order. The result is empty if there are fewer than three different sizes with finite values, or
// if no order in the range above fits the values. Throws InvalidInput as fit_power_law() does.
std::optional<Extrapolation> extrapolate(std::span<const double> sizes,
                                         std::span<const double> values);

}  // namespace vdwmesh
