// Tests of many sets of balls unlike proteins.
#pragma once

#include <gtest/gtest.h>

#include <iterator>

#include "support/ball_families.hpp"

namespace vdwmesh::testing {

// Calls check(balls, dice, seed) for sets of the families in turn, with the seeds below `sets` and
// the dice that made the set, until a test fails.
template <class Check>
void for_sets_of_families(unsigned sets, const Check& check) {
  for (unsigned seed = 0; seed < sets; ++seed) {
    const BallFamily& family = kBallFamilies[seed % std::size(kBallFamilies)];
    SCOPED_TRACE(::testing::Message() << family.name << ", seed " << seed);
    Dice dice(seed);
    check(family.make(dice), dice, seed);
    if (::testing::Test::HasFailure()) return;
  }
}

}  // namespace vdwmesh::testing
