// The field formulas, written once for host and device, float and double.
// Blinn, ACM TOG 1 (1982) 235; soft objects: Wyvill et al., Visual Computer 2 (1986) 227.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "extract/blended/exponential.hpp"
#include "extract/field.hpp"

namespace vdwmesh {

// The numbers of a FieldModel in the precision of the evaluation.
template <class T>
struct ShapeParameters {
  T steepness, offset, amplitude, min_square, inverse_cutoff, window_scale;
};

template <class T>
VDWMESH_HD inline ShapeParameters<T> shape_parameters(const FieldModel& m) {
  return {static_cast<T>(m.steepness),      static_cast<T>(m.offset),
          static_cast<T>(m.amplitude),      static_cast<T>(m.min_square),
          static_cast<T>(m.inverse_cutoff), static_cast<T>(m.window_scale)};
}

// s of a sphere: q = d^2 * s.
VDWMESH_HD inline double inverse_square_scale(const FieldModel& m, double radius) {
  return m.uniform_scale > 0 ? m.uniform_scale : m.radius_scale / (radius * radius);
}

// Squared distance beyond which f is exactly 0; infinite under a sub-grid. Å².
VDWMESH_HD inline double field_reach_square(const FieldModel& m, double scale) {
  if (m.kind == FieldKind::soft_object) return 1 / scale;
  return m.inverse_cutoff > 0 ? 1 / (m.inverse_cutoff * scale) : 1e30;
}

// How far from its centre the sphere matters: its radius for vdw, else where f_i ends (along an
// axis, for a sub-grid). Å. The slack is for float32 coordinates: an atom that a brick's list
// leaves out adds exactly 0 there, whichever brick computes the node.
VDWMESH_HD inline double field_reach(const FieldModel& m, double radius) {
  const double slack = 1e-4 * radius + 1e-5 * m.grid.spacing;
  if (m.kind == FieldKind::vdw) return radius;
  if (m.truncation == Truncation::window) {
    return (m.kind == FieldKind::soft_object ? 2.0 : 2.5) * radius + slack;
  }
  const double box = (m.subgrid_cells + 1) * m.grid.spacing;
  if (m.kind != FieldKind::soft_object) return box + slack;
  const double reach = 1 / std::sqrt(m.uniform_scale);
  return (reach < box ? reach : box) + slack;
}

// window_scale * (1 - q * inverse_cutoff), not below 0: the square root of w(q).
template <class T>
VDWMESH_HD inline T window_root(const ShapeParameters<T>& p, T q) {
  const T u = std::fma(-q, p.inverse_cutoff, T(1));
  return p.window_scale * (u > T(0) ? u : T(0));
}

// f at squared distance d2 from an atom of scale s.
template <FieldKind kind, class T>
VDWMESH_HD inline T shape_value(const ShapeParameters<T>& p, T d2, T s) {
  if constexpr (kind == FieldKind::blinn) {
    const T q = d2 * s;
    const T u = window_root(p, q);
    return exponential(p.steepness * (p.offset - q)) * (u * u);
  } else if constexpr (kind == FieldKind::soft_object) {
    const T q = d2 * s;
    const T cubic =
        std::fma(q, std::fma(q, std::fma(q, T(-4) / T(9), T(17) / T(9)), T(-22) / T(9)), T(1));
    return q < T(1) ? p.amplitude * cubic : T(0);
  } else {
    const T q = (d2 > p.min_square ? d2 : p.min_square) * s;
    const T u = window_root(p, q);
    return (u * u) / q;
  }
}

template <class T>
struct ValueAndSlope {
  T value;
  T slope;  // df/d(d^2), 1/Å²
};

// f and its derivative by the squared distance: grad f = 2 * slope * (p - c).
template <FieldKind kind, class T>
VDWMESH_HD inline ValueAndSlope<T> shape_value_and_slope(const ShapeParameters<T>& p, T d2, T s) {
  if constexpr (kind == FieldKind::blinn) {
    const T q = d2 * s;
    const T u = window_root(p, q);
    const T e = exponential(p.steepness * (p.offset - q));
    const T window_slope = T(-2) * u * (p.window_scale * p.inverse_cutoff);
    return {e * (u * u), s * (e * std::fma(-p.steepness, u * u, window_slope))};
  } else if constexpr (kind == FieldKind::soft_object) {
    const T q = d2 * s;
    const T cubic =
        std::fma(q, std::fma(q, std::fma(q, T(-4) / T(9), T(17) / T(9)), T(-22) / T(9)), T(1));
    const T square = std::fma(q, std::fma(q, T(-4) / T(3), T(34) / T(9)), T(-22) / T(9));
    return q < T(1) ? ValueAndSlope<T>{p.amplitude * cubic, s * (p.amplitude * square)}
                    : ValueAndSlope<T>{T(0), T(0)};
  } else {
    const T q = (d2 > p.min_square ? d2 : p.min_square) * s;
    const T u = window_root(p, q);
    const T window_slope = T(-2) * u * (p.window_scale * p.inverse_cutoff);
    const T slope = (std::fma(window_slope, q, -(u * u)) / q) / q;
    return {(u * u) / q, d2 > p.min_square ? s * slope : T(0)};
  }
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
