// Measures of batches of excluded surfaces beside each other.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "excluded/excluded_measurer.hpp"

namespace vdwmesh::testing {

// What backends may differ by: a share of the set's area, and of its accessible volume.
inline constexpr double kSameExcluded = 1e-11;

inline std::vector<Sphere> spheres_of(const SphereSet& set) {
  return {set.spheres().begin(), set.spheres().end()};
}

inline void expect_same_totals(const ExcludedTotals& found, const ExcludedTotals& expected) {
  const double area = kSameExcluded * expected.area,
               volume = kSameExcluded * expected.accessible_volume;
  EXPECT_NEAR(found.area, expected.area, area);
  EXPECT_NEAR(found.area_by_kind.contact, expected.area_by_kind.contact, area);
  EXPECT_NEAR(found.area_by_kind.saddle, expected.area_by_kind.saddle, area);
  EXPECT_NEAR(found.area_by_kind.concave, expected.area_by_kind.concave, area);
  EXPECT_NEAR(found.volume, expected.volume, volume);
  EXPECT_NEAR(found.check_volume, expected.volume, volume);
  EXPECT_NEAR(found.layer_by_kind.contact, expected.layer_by_kind.contact, volume);
  EXPECT_NEAR(found.layer_by_kind.saddle, expected.layer_by_kind.saddle, volume);
  EXPECT_NEAR(found.layer_by_kind.concave, expected.layer_by_kind.concave, volume);
  EXPECT_EQ(found.euler_characteristic, expected.euler_characteristic);
  EXPECT_EQ(found.counts.arcs, expected.counts.arcs);
  EXPECT_EQ(found.counts.whole_rings, expected.counts.whole_rings);
  EXPECT_EQ(found.counts.spindle_saddles, expected.counts.spindle_saddles);
  EXPECT_EQ(found.counts.probes, expected.counts.probes);
  EXPECT_EQ(found.counts.low_probes, expected.counts.low_probes);
  EXPECT_EQ(found.counts.crease_arcs, expected.counts.crease_arcs);
  EXPECT_EQ(found.counts.cusps, expected.counts.cusps);
}

inline void expect_same(const ExcludedBatch& found, const ExcludedBatch& expected) {
  ASSERT_EQ(found.totals.size(), expected.totals.size());
  for (std::size_t s = 0; s < found.totals.size(); ++s) {
    expect_same_totals(found.totals[s], expected.totals[s]);
  }
  ASSERT_EQ(found.per_atom.size(), expected.per_atom.size());
  double area = 0, volume = 0;
  for (const ExcludedTotals& t : expected.totals) {
    area = std::max(area, kSameExcluded * t.area);
    volume = std::max(volume, kSameExcluded * t.accessible_volume);
  }
  double worst_area = 0, worst_volume = 0;
  for (std::size_t i = 0; i < found.per_atom.size(); ++i) {
    const ExcludedAtom &a = found.per_atom[i], &b = expected.per_atom[i];
    worst_area = std::max({worst_area, std::abs(a.area.contact - b.area.contact),
                           std::abs(a.area.saddle - b.area.saddle),
                           std::abs(a.area.concave - b.area.concave)});
    worst_volume = std::max(worst_volume, std::abs(a.volume - b.volume));
  }
  EXPECT_TRUE(worst_area <= area) << worst_area << " of " << area;
  EXPECT_TRUE(worst_volume <= volume) << worst_volume << " of " << volume;
}

// A set that a device measured wrongly does not prove itself, so that the host measures it: then
// its figures are right although nothing on the device is. Sets without a probe that touches four
// atoms are expected to need no such help, and little with circles, corners and patches.
inline void expect_little_help(const ExcludedBatch& found, const ExcludedBatch& expected) {
  std::uint64_t crowded = 0, elements = 0;
  for (const ExcludedTotals& t : expected.totals) {
    crowded += t.counts.crowded_probes > 0;
    elements += t.counts.arcs + t.counts.probes;
  }
  EXPECT_LE(found.host_sets, crowded);
  if (crowded > 0) return;
  EXPECT_LE(100 * (found.host_circles + found.host_corners + found.host_patches), elements);
}

}  // namespace vdwmesh::testing
