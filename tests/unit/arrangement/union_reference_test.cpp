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

}  // namespace
}  // namespace vdwmesh
