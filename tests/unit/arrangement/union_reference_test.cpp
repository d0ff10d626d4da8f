// The exact union against the published reference sets, probes 0 and 1.4 Å.
#include "union_reference_sets.hpp"

namespace vdwmesh {
namespace {

TEST(UnionReference, AllSetsButTheRibosome) {
  VDWMESH_NEEDS_SHARED("reference/union_of_balls.csv");
  for (const auto& row : testing::reference_rows()) {
    if (row.set != "6ZU5") testing::expect_row(row);
  }
}

}  // namespace
}  // namespace vdwmesh
