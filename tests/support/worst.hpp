// The worst of many errors, for tests.
#pragma once

#include <cmath>
#include <limits>

namespace vdwmesh::testing {

// The larger of two values, and NaN where either is: std::max would pass over a NaN, and a test
// that takes the worst of many values could not fail on it.
inline double worst(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<double>::quiet_NaN();
  return a < b ? b : a;
}

}  // namespace vdwmesh::testing
