// Blinn's field, ACM Transactions on Graphics 1 (1982) 235. Host and device.
//
//   f = exp(B (o - q)) w(q),   q = s d^2,   w(q) = (W (1 - k q))^2 up to its zero, then 0
//
// At the nodes of a grid f is a product of terms of one axis each, so that an atom needs one
// exponential per node plane, not one per node: with q = qx + qy + qz and g = exp(-B q / 2) of each
// axis,
//   f = exp(B o) W^2 (gy gz)^2 (gx (1 - k (qy + qz)) - k qx gx)^2,
// and the bracket, cut at 0, takes one fma. An axis contributes {k q, g}, along x {k qx gx, gx}; a
// row {1 - k (qy + qz), exp(B o) W^2 (gy gz)^2}.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/host_device.hpp"
#include "extract/blended/exponential.hpp"
#include "extract/blended/kind_types.hpp"

namespace vdwmesh {

struct Blinn {
  // False only where f is exactly 0.
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

  template <class T>
  VDWMESH_HD static ValueAndSlope<T> value_and_slope(const ShapeParameters<T>& p, T d2, T s) {
    const T q = d2 * s;
    const T u = window_root(p, q);
    const T e = exponential(p.steepness * (p.offset - q));
    const T window_slope = T(-2) * u * (p.window_scale * p.inverse_cutoff);
    return {e * (u * u), s * (e * std::fma(-p.steepness, u * u, window_slope))};
  }

  // It is convex in d^2 everywhere, and its rounding is relative.
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

  VDWMESH_HD static float add_atom(const NodeShape&, const RowTerm& row, const AxisTerm& x, float,
                                   float sum) {
    const float root = positive_part(std::fma(row.rest, x.factor, -x.square));
    return std::fma(root * root, row.factor, sum);
  }

  // Parameters of the presets; those of the thesis are fitted to its counts: docs/thesis.md.
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
  // The largest number that a product of float32 terms at a node begins with.
  static double largest_factor(const FieldModel& m) {
    return std::max(1.0, std::exp(m.steepness * m.offset) * m.window_scale * m.window_scale);
  }
};

}  // namespace vdwmesh
