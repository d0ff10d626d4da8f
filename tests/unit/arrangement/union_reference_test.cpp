// The exact union against the published reference sets, probes 0 and 1.4 Å.
#include "union_reference_sets.hpp"

namespace vdwmesh {
namespace {

TEST(UnionReference, AllSetsButTheRibosome) {
  VDWMESH_NEEDS_SHARED("reference/union_of_balls.csv");
  constexpr std::size_t kRows = 48;  // 24 sets with two probes
  for (const auto& row :
       testing::wanted_rows(kRows, [](const std::string& set) { return set != "6ZU5"; })) {
    testing::expect_row(row);
  }
}

// Only the cube's counts at 1.4 Å hang on rounding: its eight balls meet in one point.
TEST(UnionReference, CountsOfAllSetsButTheRibosome) {
  VDWMESH_NEEDS_SHARED("reference/union_of_balls.csv");
  constexpr std::size_t kRows = 48;
  std::vector<std::string> refused;
  for (const auto& row :
       testing::wanted_rows(kRows, [](const std::string& set) { return set != "6ZU5"; })) {
    if (!testing::expect_counts_of_row(row)) refused.push_back(row.set);
  }
  EXPECT_EQ(refused, std::vector<std::string>{"cube"});
}

}  // namespace
}  // namespace vdwmesh
