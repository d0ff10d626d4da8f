// The types that the formulas of all kinds of blended fields share: the parameters that they take,
// in the precision of the evaluation, and the terms that they return. The concept BlendedKind in
// field_kinds.hpp says which functions a kind has. Host and device.
#pragma once

#include <cmath>
#include <type_traits>

#include "core/host_device.hpp"
#include "extract/field.hpp"

namespace vdwmesh {

// The members of FieldModel of the same names, as T. The evaluation at arbitrary points uses these;
// the evaluation at grid nodes uses NodeShape.
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

// The window of radius-aware fields ends at this distance from the atom's centre, in radii.
inline constexpr double kWindowRadii = 2.5;

// The square root of the window w(q), the factor that ends a field smoothly: W (1 - k q) up to its
// zero, then 0, with W = window_scale and k = inverse_cutoff. Neither q nor k is below 0, so the
// argument of positive_part() is at most 1.
template <class T>
VDWMESH_HD inline T window_root(const ShapeParameters<T>& p, T q) {
  const T u = std::fma(-q, p.inverse_cutoff, T(1));
  if constexpr (std::is_same_v<T, float>) return p.window_scale * positive_part(u);
  return p.window_scale * (u > T(0) ? u : T(0));
}

template <class T>
struct ValueAndSlope {
  T value;  // f, what one atom contributes at the squared distance d^2
  T slope;  // df/d(d^2), 1/Å²; 0 or negative
};

// The parameters of a field for sums at nodes, in float32. A kind's node_shape() sets the members
// that the kind uses; the others are 0.
struct NodeShape {
  float half_steepness;  // Blinn: B / 2
  float amplitude;       // Blinn: exp(B o) W^2; soft object: its amplitude
  float inverse_cutoff;  // k
  float window_scale;    // W
  float min_square;      // inverse squared, Å²
};

// What one atom and one plane of nodes, across one axis, give to the products at the nodes of the
// plane. The header of each kind defines the two numbers. They are {0, 0} for a plane outside the
// atom's sub-grid.
struct AxisTerm {
  float square, factor;
};

// What one atom gives to all nodes of one row along x: the axis terms of y and z combined. The
// header of each kind defines the two numbers.
struct RowTerm {
  float rest;    // what remains of q or of the window's root: from the squares of y and z
  float factor;  // product of all factors that do not depend on x
};

}  // namespace vdwmesh
