// The triangle nearest to a point, for host and device.
#pragma once

#include <cstdint>

#include "analysis/box_tree_view.hpp"
#include "analysis/distances_triangle.hpp"
#include "analysis/triangle_points.hpp"
#include "core/host_device.hpp"

namespace vdwmesh {

VDWMESH_HD inline double squared_distance_to(const Vec3d& p, const Corners& t) {
  return squared_distance_to_triangle(p, t.a, t.b, t.c);
}

// Returns the squared distance of p to the nearest triangle, Å². The primitives of the tree are the
// triangles, and corners_of(t) returns the corners of triangle t. `nearest` is the triangle that is
// measured first, and becomes the nearest one. The result is the least of all triangles' squared
// distances, so it does not depend, to the last bit, on the triangle that is measured first.
template <class CornersOf>
VDWMESH_HD inline double nearest_triangle(const BoxTreeView& tree, const CornersOf& corners_of,
                                          const Vec3d& p, std::uint32_t& nearest) {
  double squared = squared_distance_to(p, corners_of(nearest));
  visit_nearest(tree, tree.query(p), squared, [&](std::uint32_t t, double& best) {
    const double here = squared_distance_to(p, corners_of(t));
    if (!(here < best)) return;
    best = here;
    nearest = t;
  });
  return squared;
}

}  // namespace vdwmesh
