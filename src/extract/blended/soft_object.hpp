// The field of soft objects: Wyvill, McPheeters and Wyvill, The Visual Computer 2 (1986) 227. Host
// and device. An atom at distance d contributes
//
//   f = A (1 - 22/9 q + 17/9 q^2 - 4/9 q^3)   for q = s d^2 < 1, else 0,
//
// with the amplitude A and the atom's scale s. Value and slope are 0 at q = 1, so f needs no
// window. At the nodes of a grid, with the squares qx, qy and qz of the axes and q = qx + qy + qz,
// an axis term {square, factor} is {qx, 1}, likewise across y and z, and a row's term {rest,
// factor} is {qy + qz, A}. Both factors are 0 for planes outside the atom's sub-grid.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "extract/blended/kind_types.hpp"

namespace vdwmesh {

struct SoftObject {
  // f / A by Horner's scheme, for q < 1.
  template <class T>
  VDWMESH_HD static T cubic(T q) {
    return std::fma(q, std::fma(q, std::fma(q, T(-4) / T(9), T(17) / T(9)), T(-22) / T(9)), T(1));
  }

  // Returns false only if f at q is exactly 0.
  template <class T>
  VDWMESH_HD static bool reaches(const ShapeParameters<T>&, T q) {
    return q < T(1);
  }

  template <class T>
  VDWMESH_HD static T value(const ShapeParameters<T>& p, T d2, T s) {
    const T q = d2 * s;
    const T shape = cubic(q);
    return q < T(1) ? p.amplitude * shape : T(0);
  }

  template <class T>
  VDWMESH_HD static ValueAndSlope<T> value_and_slope(const ShapeParameters<T>& p, T d2, T s) {
    const T q = d2 * s;
    const T shape = cubic(q);
    // The derivative of the cubic by q: -22/9 + 34/9 q - 12/9 q^2.
    const T square = std::fma(q, std::fma(q, T(-4) / T(3), T(34) / T(9)), T(-22) / T(9));
    return q < T(1) ? ValueAndSlope<T>{p.amplitude * shape, s * (p.amplitude * square)}
                    : ValueAndSlope<T>{T(0), T(0)};
  }

  // f is convex in d^2 everywhere: the second derivative of the cubic, 34/9 - 24/9 q, is positive
  // up to q = 17/12, and f ends at q = 1 with slope 0. Near q = 1 the cubic is a small difference
  // of terms of up to 22/9, so its rounding error is relative to the amplitude, not to the value,
  // and has either sign.
  template <class T>
  VDWMESH_HD static bool is_convex_beyond(const ShapeParameters<T>&, T) {
    return true;
  }
  template <class T>
  VDWMESH_HD static T absolute_rounding(const ShapeParameters<T>& p) {
    constexpr T kRounding = T(4e-6);  // 67 units of 2^-24, relative to the amplitude
    return kRounding * p.amplitude;
  }

  VDWMESH_HD static NodeShape node_shape(const FieldModel& m) {
    return {0, static_cast<float>(m.amplitude), 0, 0, 0};
  }

  VDWMESH_HD static AxisTerm axis_term(const NodeShape&, float scale, int, float offset) {
    return {offset * offset * scale, 1.0f};
  }

  VDWMESH_HD static RowTerm row_term(const NodeShape& p, const AxisTerm& y, const AxisTerm& z) {
    const float square = y.square + z.square, factor = y.factor * z.factor;
    return {square, p.amplitude * factor};
  }

  VDWMESH_HD static bool row_is_out_of_reach(const NodeShape&, const RowTerm& row) {
    return row.rest >= 1;
  }

  VDWMESH_HD static float add_atom(const NodeShape&, const RowTerm& row, const AxisTerm& x, float,
                                   float sum) {
    const float q = row.rest + x.square;
    const float shape = cubic(q);
    return std::fma(q < 1 ? shape : 0.0f, row.factor * x.factor, sum);
  }

  // Parameters of the presets; the thesis's are fitted to its triangle counts: docs/thesis.md. The
  // radius-aware field ends at d = 2 R, where q = 1. At d = R, q = 1/4 and the cubic is 1/2, so the
  // amplitude 2 makes f = 1 on the atom's sphere.
  static void set_radius_aware(const FieldOptions&, FieldModel& m) {
    m.amplitude = 2;
    m.radius_scale = 0.25;
    m.reach_radii = 2;
  }
  static void set_thesis(const FieldOptions& options, FieldModel& m) {
    constexpr double kReach = 1.6;  // Å
    m.amplitude = 1;
    m.uniform_scale = 1 / (kReach * kReach);
    m.most_reach = 1 / std::sqrt(m.uniform_scale);
    m.isovalue = options.isovalue.value_or(0.63);
  }
  static double largest_factor(const FieldModel&) { return 1; }
};

}  // namespace vdwmesh
