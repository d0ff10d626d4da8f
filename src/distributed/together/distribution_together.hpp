// The distribution of values of which every rank has some.
#pragma once

#include <optional>
#include <vector>

#include "analysis/distances/distribution.hpp"
#include "distributed/ranks.hpp"

namespace vdwmesh {

// The brackets from the samples of all ranks; the same on all ranks. Collective.
Brackets brackets_together(const Ranks& ranks, const std::vector<double>& sample);

// What distribution_of() says of the values of all ranks, bit for bit; the same on all ranks, and
// nothing where it says nothing. Precondition: all ranks have the same brackets. Collective.
std::optional<Distribution> distribution_together(const Ranks& ranks,
                                                  const BracketedValues& values);

}  // namespace vdwmesh
