// What exact measures of the solvent-excluded surface owe, whatever the atoms: checks that every
// test of them makes.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "excluded/excluded_measures.hpp"
#include "reference/excluded_forms.hpp"
#include "reference/point.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh::testing {

// Share of the accessible solid's area and volume. Sums over some thousand terms, each of some
// fifty operations with numbers of that size, are wrong by 1e-12 at most, unless corners are
// ill-conditioned.
inline constexpr double kExcludedRounding = 1e-11;

SphereSet equal_spheres(const std::vector<reference::Point>& centers, double radius);
SphereSet to_spheres(const std::vector<reference::Ball>& balls);
std::vector<reference::Ball> reference_balls(const SphereSet& spheres);

// With everything that can be wanted.
ExcludedMeasures measure_excluded(const SphereSet& atoms, double probe);

// Whether the result finds nothing wrong with itself: no patch is uncertified, and the theorem of
// Gauss and Bonnet holds.
bool is_certified(const ExcludedMeasures& measures);

// Totals, parts, atoms, shells, components and checks agree with each other, and with the exact
// unions of the atoms and of the grown balls.
void expect_sound(const SphereSet& atoms, const ExcludedMeasures& measures);

// Area by kind, and volume. The tolerance is relative to the whole area and volume.
void expect_form(const ExcludedSurface& found, const reference::ExcludedForm& expected,
                 double tolerance = kExcludedRounding);

// The same totals and parts, when lengths of `found` are `scale` times those of `expected`.
void expect_same_measures(const ExcludedSurface& found, const ExcludedSurface& expected,
                          double tolerance = kExcludedRounding, double scale = 1);
void expect_same_topology(const ExcludedTopology& found, const ExcludedTopology& expected);
void expect_same_counts(const ExcludedCounts& found, const ExcludedCounts& expected);

}  // namespace vdwmesh::testing
