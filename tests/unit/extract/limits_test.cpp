#include "extract/limits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "extract/extractor.hpp"

namespace vdwmesh {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Limits, AreSaidWithNeedAllowanceAndWhatFits) {
  const MeshDemand demand{{1000, 2000}, {}, 0, 0.5};
  // 1000 vertices of 24 + 12 + 4 bytes, 2000 triangles of 12.
  EXPECT_NO_THROW(check_mesh_limits(demand, 64000));
  EXPECT_THAT([&] { check_mesh_limits(demand, 16000); },
              ThrowsMessage<LimitExceeded>(
                  ::testing::AllOf(HasSubstr("64000"), HasSubstr("16000"), HasSubstr("1.02 Å"))));
}

TEST(Limits, OfVertexAndHalfEdgeNumbers) {
  MeshDemand demand{{kMaxVertices + 1, 10}, {}, 0, 0.5};
  EXPECT_THROW(check_mesh_limits(demand, kNoMemoryLimit), LimitExceeded);
  demand.size = {10, kMaxHalfEdges / 3 + 1};
  demand.arrays.connectivity = Connectivity::half_edges;
  EXPECT_THROW(check_mesh_limits(demand, kNoMemoryLimit), LimitExceeded);
  demand.arrays.connectivity = Connectivity::triangles;
  EXPECT_NO_THROW(check_mesh_limits(demand, kNoMemoryLimit));
}

TEST(Limits, StopTheExtractorBeforeItTakesTheMesh) {
  ExtractOptions options;
  options.grid.spacing = 0.05;
  options.memory_limit = 1 << 20;
  EXPECT_THROW(make_cpu_extractor()->extract(SphereSet({{{0, 0, 0}, 5.0}}), options),
               LimitExceeded);
}

}  // namespace
}  // namespace vdwmesh
