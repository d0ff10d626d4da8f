// Minimum, maximum, mean and percentiles of many values, without sorting them.
#pragma once

#include <span>

#include "analysis/mesh_measures.hpp"

namespace vdwmesh {

// Returns the distribution of the values. A percentile is an element of the set: the p-th
// percentile of n values is the value of rank ceil(p n / 100), counted from 1. The mean is computed
// from a compensated sum (WideSum) and does not depend on the number of threads. Without values all
// members are NaN. Precondition: the values are at or above 0 and have no sign bit, so -0.0 is not
// allowed.
Distribution distribution_of(std::span<const double> values);

}  // namespace vdwmesh
