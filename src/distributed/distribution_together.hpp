// The distribution of values of which every rank has some.
#pragma once

#include <span>

#include "analysis/distribution.hpp"
#include "distributed/ranks.hpp"

namespace vdwmesh {

// What distribution_of() says of the values of all ranks, bit for bit; the same on all ranks.
// Collective.
Distribution distribution_together(const Ranks& ranks, std::span<const double> values);

}  // namespace vdwmesh
