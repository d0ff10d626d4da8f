// What extraction knows of one vertex before it is numbered.
#pragma once

#include <cmath>

#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

struct EdgeVertex {
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

// No component is chosen by a variable here and below: on a device the whole would have to stand in
// memory for that.
VDWMESH_HD inline CrossedEdge crossed_edge(bool lower_inside, int x, int y, int z, int axis) {
  const int upper[3] = {x + (axis == 0 ? 1 : 0), y + (axis == 1 ? 1 : 0), z + (axis == 2 ? 1 : 0)};
  if (lower_inside) return {{x, y, z}, {upper[0], upper[1], upper[2]}, axis, 1.0};
  return {{upper[0], upper[1], upper[2]}, {x, y, z}, axis, -1.0};
}

// The point at a distance (Å) from the inside end, `node`.
VDWMESH_HD inline Vec3d point_on_edge(const CrossedEdge& edge, const Vec3d& node, double distance) {
  return {edge.axis == 0 ? std::fma(edge.direction, distance, node.x) : node.x,
          edge.axis == 1 ? std::fma(edge.direction, distance, node.y) : node.y,
          edge.axis == 2 ? std::fma(edge.direction, distance, node.z) : node.z};
}

// Unit vector from the inside end to the outside one.
VDWMESH_HD inline Vec3d edge_direction(const CrossedEdge& edge) {
  return {edge.axis == 0 ? edge.direction : 0, edge.axis == 1 ? edge.direction : 0,
          edge.axis == 2 ? edge.direction : 0};
}

}  // namespace vdwmesh
