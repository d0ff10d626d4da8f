// The float32 value of a blended field at a grid node, as a product of terms of one axis each: an
// atom needs one exponential per node plane, not one per node. Host and device.
//
// With q = s d^2 = qx + qy + qz, Blinn's f = exp(B (o - q)) (W (1 - k q))^2 is
//   exp(B o) W^2 (gy gz)^2 (gx (1 - k (qy + qz)) - k qx gx)^2,   g = exp(-B q / 2) of each axis,
// and the bracket, cut at 0, takes one fma.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"
#include "extract/blended/field_formulas.hpp"

namespace vdwmesh {

// The numbers of a FieldModel that sums at nodes need.
struct NodeShape {
  float half_steepness;  // Blinn: B / 2
  float amplitude;       // Blinn: exp(B o) W^2; soft object: its amplitude
  float inverse_cutoff;  // k
  float window_scale;    // W
  float min_square;      // inverse squared, Å²
};

VDWMESH_HD inline NodeShape node_shape(const FieldModel& m) {
  const bool blinn = m.kind == FieldKind::blinn;
  const double peak = exponential(m.steepness * m.offset) * (m.window_scale * m.window_scale);
  return {static_cast<float>(0.5 * m.steepness), static_cast<float>(blinn ? peak : m.amplitude),
          static_cast<float>(m.inverse_cutoff), static_cast<float>(m.window_scale),
          static_cast<float>(m.min_square)};
}

// What an atom and a plane of nodes across one axis contribute.
//   Blinn: k q of the axis, and g. Else: q of the axis, and 1.
// A plane outside the atom's sub-grid: 0 and 0. Along x, Blinn's first number is k qx gx.
struct AxisTerm {
  float square, factor;
};

// `offset`: node less centre, Å. Depends on atom and plane alone, not on the brick that asks.
template <FieldKind kind>
VDWMESH_HD inline AxisTerm axis_term(const NodeShape& p, float scale, int axis, float offset) {
  const float q = offset * offset * scale;
  if constexpr (kind != FieldKind::blinn) return {q, 1.0f};
  const float g = exponential(-p.half_steepness * q);
  const float square = q * p.inverse_cutoff;
  return {axis == 0 ? square * g : square, g};
}

// An atom's terms for a row of nodes along x.
struct RowTerm {
  float rest;    // Blinn: 1 - k (qy + qz). Else: qy + qz
  float factor;  // all factors that do not depend on x
};

template <FieldKind kind>
VDWMESH_HD inline RowTerm row_term(const NodeShape& p, const AxisTerm& y, const AxisTerm& z) {
  const float square = y.square + z.square, factor = y.factor * z.factor;
  if constexpr (kind == FieldKind::blinn) return {1.0f - square, p.amplitude * (factor * factor)};
  if constexpr (kind == FieldKind::soft_object) return {square, p.amplitude * factor};
  return {square, factor};
}

// True only where the atom adds exactly 0 to every node of the row.
template <FieldKind kind>
VDWMESH_HD inline bool row_is_out_of_reach(const NodeShape& p, const RowTerm& row) {
  if constexpr (kind == FieldKind::blinn) return !(row.rest > 0);
  if constexpr (kind == FieldKind::soft_object) return row.rest >= 1;
  return row.rest * p.inverse_cutoff > 1;
}

// The sum over atoms at a node, one atom further.
template <FieldKind kind>
VDWMESH_HD inline float add_atom(const NodeShape& p, const RowTerm& row, const AxisTerm& x,
                                 float scale, float sum) {
  if constexpr (kind == FieldKind::blinn) {
    const float root = positive_part(std::fma(row.rest, x.factor, -x.square));
    return std::fma(root * root, row.factor, sum);
  } else if constexpr (kind == FieldKind::soft_object) {
    const float q = row.rest + x.square;
    const float cubic =
        std::fma(q, std::fma(q, std::fma(q, -4.0f / 9.0f, 17.0f / 9.0f), -22.0f / 9.0f), 1.0f);
    return std::fma(q < 1 ? cubic : 0.0f, row.factor * x.factor, sum);
  } else {
    const float far = row.rest + x.square, least = p.min_square * scale;
    const float q = far > least ? far : least;
    const float u = p.window_scale * positive_part(std::fma(-q, p.inverse_cutoff, 1.0f));
    return std::fma((u * u) / q, row.factor * x.factor, sum);
  }
}

}  // namespace vdwmesh
