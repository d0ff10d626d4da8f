// The ribosome 6ZU5 (165,175 balls) against the published values.
#include "union_reference_sets.hpp"

namespace vdwmesh {
namespace {

TEST(UnionLarge, Ribosome) {
  VDWMESH_NEEDS_SHARED("reference/union_of_balls.csv");
  for (const auto& row :
       testing::wanted_rows(2, [](const std::string& set) { return set == "6ZU5"; })) {
    testing::expect_row(row);
    testing::expect_certified_row(row);
    EXPECT_TRUE(testing::expect_counts_of_row(row));
  }
}

}  // namespace
}  // namespace vdwmesh
