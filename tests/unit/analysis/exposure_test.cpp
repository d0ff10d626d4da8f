#include "analysis/exposure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace vdwmesh::testing {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Atom atom(const char* name, Polarity polarity) {
  Atom result;
  result.name = name;
  result.polarity = polarity;
  return result;
}

Molecule molecule() {
  Molecule result;
  result.has_polarity = true;
  result.atoms = {atom("N", Polarity::polar),   atom("CA", Polarity::apolar),
                  atom("CB", Polarity::apolar), atom("OG", Polarity::polar),
                  atom("X", Polarity::unknown), atom("CG", Polarity::apolar)};
  return result;
}

// The last atom was not measured.
ExactUnion areas() {
  ExactUnion result{};
  result.per_sphere = {{1, 0}, {2, 0}, {4, 0}, {8, 0}, {16, 0}, {kNaN, kNaN}};
  return result;
}

TEST(Exposure, PartsByPolarityAreOfMeasuredAtoms) {
  const auto parts = area_by_polarity(molecule(), areas());
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->polar, 1 + 8);
  EXPECT_EQ(parts->apolar, 2 + 4);
  EXPECT_EQ(parts->unclassified, 16);
  Molecule by_element = molecule();
  by_element.has_polarity = false;
  EXPECT_FALSE(area_by_polarity(by_element, areas()));
}

TEST(Exposure, ResidueHasMainAndSideChain) {
  ResidueSum sum;
  for (std::size_t i = 0; i < 5; ++i) sum.add(molecule().atoms[i], areas().per_sphere[i].area);
  const ResidueAreas parts = sum.areas();
  EXPECT_EQ(parts.total, 31);
  EXPECT_EQ(parts.main_chain, 1 + 2);
  EXPECT_EQ(parts.side_chain, 4 + 8 + 16);
  EXPECT_EQ(parts.polar, 1 + 8);
  EXPECT_EQ(parts.apolar, 2 + 4);
  EXPECT_EQ(sum.unclassified_area(), 16);
}

TEST(Exposure, SharesOfNothingAreNaN) {
  const ResidueAreas glycine{80, 80, 0, 40, 32};
  const ResidueAreas shares = relative_areas({40, 40, 0, 10, 32}, glycine);
  EXPECT_EQ(shares.total, 0.5);
  EXPECT_EQ(shares.main_chain, 0.5);
  EXPECT_TRUE(std::isnan(shares.side_chain));
  EXPECT_EQ(shares.polar, 0.25);
  EXPECT_EQ(shares.apolar, 1);
}

}  // namespace
}  // namespace vdwmesh::testing
