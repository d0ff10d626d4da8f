// Order statistics of many values without sorting them.
#pragma once

#include <span>

#include "analysis/mesh_measures.hpp"

namespace vdwmesh {

// Values at or above 0. Percentiles are values of the set: p of n is that of rank ceil(p n / 100).
// The mean is of a wide sum, block by block in order. All are NaN where there are no values.
Distribution distribution_of(std::span<const double> values);

}  // namespace vdwmesh
