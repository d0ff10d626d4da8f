// What extraction knows of one vertex before it is numbered.
#pragma once

#include "core/vec3.hpp"
#include "extract/sphere_set.hpp"

namespace vdwmesh {

struct SurfaceVertex {
  Vec3d position;  // Å
  Vec3f normal;    // unit, outward
  SphereId sphere;
  bool clamped;
};

// Unit vector along g, or `fallback` where g is 0 or not finite.
VDWMESH_HD inline Vec3f unit_or(const Vec3d& g, const Vec3d& fallback) {
  const double length = norm(g);
  if (!(length > 0) || !(length < 1e300)) return cast<float>(fallback);
  return {static_cast<float>(g.x / length), static_cast<float>(g.y / length),
          static_cast<float>(g.z / length)};
}

// An edge of the lattice seen from its inside end.
struct CrossedEdge {
  int inside[3], outside[3];  // local node indices of the brick
  int axis;
  double direction;  // +1 where the outside node is the upper one
};

VDWMESH_HD inline CrossedEdge crossed_edge(bool lower_inside, int x, int y, int z, int axis) {
  CrossedEdge e{{x, y, z}, {x, y, z}, axis, lower_inside ? 1.0 : -1.0};
  ++(lower_inside ? e.outside : e.inside)[axis];
  return e;
}

}  // namespace vdwmesh
