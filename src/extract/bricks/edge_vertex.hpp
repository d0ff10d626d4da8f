// One vertex of the mesh as the formulas of a field make it, and the grid edge that carries it.
// Host and device.
#pragma once

#include <cmath>

#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

struct EdgeVertex {
  Vec3d position;   // Å
  Vec3f normal;     // unit, outward
  SphereId sphere;  // the label: id of the vertex's atom; kNoSphere for a sampled field
  bool clamped;     // moved, to keep a distance of kEdgeMargin edge lengths from an end of its edge
};

// Unit vector along g, or `fallback` if the length of g is 0 or not finite.
VDWMESH_HD inline Vec3f unit_or(const Vec3d& g, const Vec3d& fallback) {
  const double length = norm(g);
  if (!(length > 0) || !(length < 1e300)) return cast<float>(fallback);
  return {static_cast<float>(g.x / length), static_cast<float>(g.y / length),
          static_cast<float>(g.z / length)};
}

// A crossed grid edge, given by its inside and its outside end.
struct CrossedEdge {
  int inside[3], outside[3];  // coordinates of the ends in the brick, 0 .. 8
  int axis;
  double direction;  // +1 if the outside end is the upper one, else -1
};

// The crossed edge from node (x, y, z) one step up along the axis. Here and below, conditional
// expressions take the place of arrays indexed by `axis`: a GPU would have to keep such an array in
// local memory instead of registers.
VDWMESH_HD inline CrossedEdge crossed_edge(bool lower_inside, int x, int y, int z, int axis) {
  const int upper[3] = {x + (axis == 0 ? 1 : 0), y + (axis == 1 ? 1 : 0), z + (axis == 2 ? 1 : 0)};
  if (lower_inside) return {{x, y, z}, {upper[0], upper[1], upper[2]}, axis, 1.0};
  return {{upper[0], upper[1], upper[2]}, {x, y, z}, axis, -1.0};
}

// The point of the edge at a distance (Å) from its inside end, which is at `node`.
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
