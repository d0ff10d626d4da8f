// The inverse squared field of the thesis (docs/thesis.md). Host and device. An atom at distance d
// contributes
//
//   f = w(q) / q,   q = s d^2,   w(q) = (W (1 - k q))^2 up to its zero, then 0.
//
// s is the atom's scale, W the window's scale and k its inverse cutoff. If d^2 is smaller than
// min_square, it is replaced by min_square, so f is finite at the centre. At the nodes of a grid,
// with the squares qx, qy and qz of the axes and q = qx + qy + qz, an axis term {square, factor} is
// {qx, 1}, likewise across y and z, and a row's term {rest, factor} is {qy + qz, 1}. Both factors
// are 0 for planes outside the atom's sub-grid.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "extract/blended/exponential.hpp"
#include "extract/blended/kind_types.hpp"

namespace vdwmesh {

struct InverseSquared {
  // Returns false only if f at q is exactly 0.
  template <class T>
  VDWMESH_HD static bool reaches(const ShapeParameters<T>& p, T q) {
    return window_root(p, q) > 0;
  }

  template <class T>
  VDWMESH_HD static T value(const ShapeParameters<T>& p, T d2, T s) {
    const T q = (d2 > p.min_square ? d2 : p.min_square) * s;
    const T u = window_root(p, q);
    return (u * u) / q;
  }

  // With u = W (1 - k q): df/dq = (-2 u W k q - u^2) / q^2, and dq/d(d^2) = s. Below min_square f
  // is constant.
  template <class T>
  VDWMESH_HD static ValueAndSlope<T> value_and_slope(const ShapeParameters<T>& p, T d2, T s) {
    const T q = (d2 > p.min_square ? d2 : p.min_square) * s;
    const T u = window_root(p, q);
    const T window_slope = T(-2) * u * (p.window_scale * p.inverse_cutoff);
    const T slope = (std::fma(window_slope, q, -(u * u)) / q) / q;
    return {(u * u) / q, d2 > p.min_square ? s * slope : T(0)};
  }

  // f is convex in d^2 from min_square on; where the constant part below min_square joins, it is
  // not. Its rounding error is relative to its value, so it has no absolute part.
  template <class T>
  VDWMESH_HD static bool is_convex_beyond(const ShapeParameters<T>& p, T d2) {
    return d2 >= p.min_square;
  }
  template <class T>
  VDWMESH_HD static T absolute_rounding(const ShapeParameters<T>&) {
    return T(0);
  }

  VDWMESH_HD static NodeShape node_shape(const FieldModel& m) {
    return {0, 0, static_cast<float>(m.inverse_cutoff), static_cast<float>(m.window_scale),
            static_cast<float>(m.min_square)};
  }

  VDWMESH_HD static AxisTerm axis_term(const NodeShape&, float scale, int, float offset) {
    return {offset * offset * scale, 1.0f};
  }

  VDWMESH_HD static RowTerm row_term(const NodeShape&, const AxisTerm& y, const AxisTerm& z) {
    return {y.square + z.square, y.factor * z.factor};
  }

  VDWMESH_HD static bool row_is_out_of_reach(const NodeShape& p, const RowTerm& row) {
    return row.rest * p.inverse_cutoff > 1;
  }

  VDWMESH_HD static float add_atom(const NodeShape& p, const RowTerm& row, const AxisTerm& x,
                                   float scale, float sum) {
    const float far = row.rest + x.square, least = p.min_square * scale;
    const float q = far > least ? far : least;
    const float u = p.window_scale * positive_part(std::fma(-q, p.inverse_cutoff, 1.0f));
    return std::fma((u * u) / q, row.factor * x.factor, sum);
  }

  // Parameters of the presets. The thesis's isovalues are fitted to its triangle counts:
  // docs/thesis.md.
  static void set_radius_aware(const FieldOptions&, FieldModel& m) { m.reach_radii = kWindowRadii; }
  static void set_thesis(const FieldOptions& options, FieldModel& m) {
    const double fitted = options.preset == FieldPreset::thesis ? 4.8 : 4.6;
    m.isovalue = options.isovalue.value_or(fitted);
  }
  static double largest_factor(const FieldModel&) { return 1; }
};

}  // namespace vdwmesh
