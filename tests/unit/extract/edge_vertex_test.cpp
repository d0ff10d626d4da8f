// Points and directions along crossed grid edges.
#include "extract/bricks/edge_vertex.hpp"

#include <gtest/gtest.h>

namespace vdwmesh {
namespace {

TEST(EdgeVertex, LiesBeyondTheInsideNodeTowardsTheOutsideOne) {
  const Vec3d units[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Vec3d node{10, 20, 30};
  for (const int axis : {0, 1, 2}) {
    for (const bool lower_inside : {true, false}) {
      const double sign = lower_inside ? 1 : -1;
      const CrossedEdge edge = crossed_edge(lower_inside, 1, 2, 3, axis);
      EXPECT_EQ(edge_direction(edge), sign * units[axis]);
      EXPECT_EQ(point_on_edge(edge, node, 0.25), node + sign * 0.25 * units[axis]);
    }
  }
}

}  // namespace
}  // namespace vdwmesh
