// What a field needs to know of one atom: the scale of its distances, its reach, whether a point
// lies in its ball, and its sub-grid. The formulas of the kinds themselves are in blinn.hpp and its
// neighbours. Host and device.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "extract/field.hpp"

namespace vdwmesh {

// The scale s of an atom, 1/Å²: every kind of field is a function of q = d^2 * s. The scale is the
// same for all atoms (thesis presets) or follows from the radius.
VDWMESH_HD inline double inverse_square_scale(const FieldModel& m, double radius) {
  return m.uniform_scale > 0 ? m.uniform_scale : m.radius_scale / (radius * radius);
}

// The reach of a sphere, Å: how far from its centre it matters. For vdw it is the radius. For a
// blended field with a window, it is where the window ends. For a field with sub-grids, it is the
// largest distance along an axis at which the atom's box of cells can end, but at most where f
// itself ends.
//
// The slack of the blended fields covers the float32 coordinates in which nodes are evaluated: an
// atom that is beyond its reach from a brick adds exactly 0 to each of the brick's nodes. So the
// bricks that share a node agree on its value although they gather different atoms.
VDWMESH_HD inline double field_reach(const FieldModel& m, double radius) {
  const double slack = 1e-4 * radius + 1e-5 * m.grid.spacing;
  if (m.kind == FieldKind::vdw) return radius;
  if (m.truncation == Truncation::window) return m.reach_radii * radius + slack;
  const double box = (m.subgrid_cells + 1) * m.grid.spacing;
  return (m.most_reach < box ? m.most_reach : box) + slack;
}

VDWMESH_HD inline double squared_distance(const Vec3d& p, const Vec3d& c) {
  const double dx = p.x - c.x, dy = p.y - c.y, dz = p.z - c.z;
  return std::fma(dx, dx, std::fma(dy, dy, dz * dz));
}

// Whether the point lies in the closed ball. For the union of balls, this predicate alone decides
// the signs of nodes, and which balls hold the inside end of an edge.
VDWMESH_HD inline bool inside_ball(const Vec3d& p, const Sphere& ball) {
  return squared_distance(p, ball.center) <= ball.radius * ball.radius;
}

// Index of the grid cell in which an atom lies, along one axis; `coordinate` is the atom's, Å. It
// is negative or beyond the last cell for atoms outside the grid.
VDWMESH_HD inline std::int64_t subgrid_cell(const GridSpec& grid, int axis, double coordinate) {
  return static_cast<std::int64_t>(std::floor((coordinate - grid.origin[axis]) / grid.spacing));
}

// Whether a point lies in the sub-grid of an atom, along one axis: between nodes cell - half_width
// and cell + half_width. `node_units` is the point's coordinate in spacings from the grid's origin,
// and `cell` the atom's subgrid_cell().
template <class T>
VDWMESH_HD inline bool in_subgrid(T node_units, std::int64_t cell, std::int32_t half_width) {
  return node_units >= static_cast<T>(cell - half_width) &&
         node_units <= static_cast<T>(cell + half_width);
}

}  // namespace vdwmesh
