// Blinn's field, ACM Transactions on Graphics 1 (1982) 235. Host and device. An atom at distance d
// contributes
//
//   f = exp(B (o - q)) w(q),   q = s d^2,   w(q) = (W (1 - k q))^2 up to its zero, then 0.
//
// s is the atom's scale. The members of FieldModel have the others: steepness (B), offset (o),
// window_scale (W) and inverse_cutoff (k). The window w ends f smoothly; k = 0 means no window.
//
// At the nodes of a grid, f is computed from terms that depend on one axis each, so an atom needs
// one exponential per node plane instead of one per node. With the squares qx, qy and qz of the
// axes, q = qx + qy + qz, and gx = exp(-B qx / 2), likewise gy and gz,
//
//   f = exp(B o) W^2 (gy gz)^2 (gx (1 - k (qy + qz)) - k qx gx)^2.
//
// The last bracket is cut off at 0; it takes one fma. The axis terms {square, factor} are {k qy,
// gy} and {k qz, gz} across y and z, and {k qx gx, gx} across x. The row's term {rest, factor} is
// {1 - k (qy + qz), exp(B o) W^2 (gy gz)^2}.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/host_device.hpp"
#include "extract/blended/exponential.hpp"
#include "extract/blended/kind_types.hpp"

namespace vdwmesh {

struct Blinn {
  // Returns false only if f at q is exactly 0.
  template <class T>
  VDWMESH_HD static bool reaches(const ShapeParameters<T>& p, T q) {
    return window_root(p, q) > 0;
  }

  template <class T>
  VDWMESH_HD static T value(const ShapeParameters<T>& p, T d2, T s) {
    const T q = d2 * s;
    const T u = window_root(p, q);
    return exponential(p.steepness * (p.offset - q)) * (u * u);
  }

  // With u = W (1 - k q) and e = exp(B (o - q)): df/dq = e (-B u^2 - 2 u W k), and dq/d(d^2) = s.
  template <class T>
  VDWMESH_HD static ValueAndSlope<T> value_and_slope(const ShapeParameters<T>& p, T d2, T s) {
    const T q = d2 * s;
    const T u = window_root(p, q);
    const T e = exponential(p.steepness * (p.offset - q));
    const T window_slope = T(-2) * u * (p.window_scale * p.inverse_cutoff);
    return {e * (u * u), s * (e * std::fma(-p.steepness, u * u, window_slope))};
  }

  // f is convex in d^2 everywhere, because it is a product of two falling, convex functions that
  // are at least 0. Its rounding error is relative to its value, so it has no absolute part.
  template <class T>
  VDWMESH_HD static bool is_convex_beyond(const ShapeParameters<T>&, T) {
    return true;
  }
  template <class T>
  VDWMESH_HD static T absolute_rounding(const ShapeParameters<T>&) {
    return T(0);
  }

  VDWMESH_HD static NodeShape node_shape(const FieldModel& m) {
    const double peak = exponential(m.steepness * m.offset) * (m.window_scale * m.window_scale);
    return {static_cast<float>(0.5 * m.steepness), static_cast<float>(peak),
            static_cast<float>(m.inverse_cutoff), static_cast<float>(m.window_scale), 0};
  }

  VDWMESH_HD static AxisTerm axis_term(const NodeShape& p, float scale, int axis, float offset) {
    const float q = offset * offset * scale;
    const float g = exponential(-p.half_steepness * q);
    const float square = q * p.inverse_cutoff;
    return {axis == 0 ? square * g : square, g};
  }

  VDWMESH_HD static RowTerm row_term(const NodeShape& p, const AxisTerm& y, const AxisTerm& z) {
    const float square = y.square + z.square, factor = y.factor * z.factor;
    return {1.0f - square, p.amplitude * (factor * factor)};
  }

  VDWMESH_HD static bool row_is_out_of_reach(const NodeShape&, const RowTerm& row) {
    return !(row.rest > 0);
  }

  // The bracket is at most 1, because 1 - k (qy + qz) and gx are: the precondition of
  // positive_part(), which returns its argument if that is above 0, else 0. The unnamed argument is
  // the atom's scale, which other kinds use.
  VDWMESH_HD static float add_atom(const NodeShape&, const RowTerm& row, const AxisTerm& x, float,
                                   float sum) {
    const float root = positive_part(std::fma(row.rest, x.factor, -x.square));
    return std::fma(root * root, row.factor, sum);
  }

  // Parameters of the presets. The offset 1 of the radius-aware preset makes f = 1 at q = 1, the
  // atom's sphere. The thesis's parameters are fitted to its triangle counts: docs/thesis.md.
  static void set_radius_aware(const FieldOptions& options, FieldModel& m) {
    constexpr double kDefaultBlobbiness = 2;
    m.steepness = options.blobbiness.value_or(kDefaultBlobbiness);
    m.offset = 1;
    m.reach_radii = kWindowRadii;
  }
  static void set_thesis(const FieldOptions& options, FieldModel& m) {
    m.steepness = 0.8;
    m.isovalue = options.isovalue.value_or(0.70);
  }
  // The largest factor in the product of float32 terms at a node: exp(B o) W^2, or 1 if that is
  // less.
  static double largest_factor(const FieldModel& m) {
    return std::max(1.0, std::exp(m.steepness * m.offset) * m.window_scale * m.window_scale);
  }
};

}  // namespace vdwmesh
