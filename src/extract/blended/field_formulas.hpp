// Where an atom of a field matters: its scale, its reach, its ball, its sub-grid. Host and device.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "extract/field.hpp"

namespace vdwmesh {

// s of a sphere: q = d^2 * s.
VDWMESH_HD inline double inverse_square_scale(const FieldModel& m, double radius) {
  return m.uniform_scale > 0 ? m.uniform_scale : m.radius_scale / (radius * radius);
}

// How far from its centre the sphere matters: its radius for vdw, else where f_i ends (along an
// axis, for a sub-grid). Å. The slack is for float32 coordinates: an atom that a brick's list
// leaves out adds exactly 0 there, whichever brick computes the node.
VDWMESH_HD inline double field_reach(const FieldModel& m, double radius) {
  const double slack = 1e-4 * radius + 1e-5 * m.grid.spacing;
  if (m.kind == FieldKind::vdw) return radius;
  if (m.truncation == Truncation::window) return m.reach_radii * radius + slack;
  const double box = (m.subgrid_cells + 1) * m.grid.spacing;
  return (m.most_reach < box ? m.most_reach : box) + slack;
}

// Whether the point lies in the closed ball: the one predicate behind node signs and edge exits.
VDWMESH_HD inline double squared_distance(const Vec3d& p, const Vec3d& c) {
  const double dx = p.x - c.x, dy = p.y - c.y, dz = p.z - c.z;
  return std::fma(dx, dx, std::fma(dy, dy, dz * dz));
}

VDWMESH_HD inline bool inside_ball(const Vec3d& p, const Sphere& ball) {
  return squared_distance(p, ball.center) <= ball.radius * ball.radius;
}

// Grid cell of an atom along one axis, and whether a point given in node units from the grid's
// origin lies in the sub-grid box [cell - n, cell + 1 + n] around it.
VDWMESH_HD inline std::int64_t subgrid_cell(const GridSpec& grid, int axis, double coordinate) {
  return static_cast<std::int64_t>(std::floor((coordinate - grid.origin[axis]) / grid.spacing));
}

template <class T>
VDWMESH_HD inline bool in_subgrid(T node_units, std::int64_t cell, std::int32_t half_width) {
  return node_units >= static_cast<T>(cell - half_width) &&
         node_units <= static_cast<T>(cell + half_width);
}

}  // namespace vdwmesh
