// The numbers that the formulas of blended fields take and give. Host and device.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
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

// Where the window of radius-aware fields ends, in radii.
inline constexpr double kWindowRadii = 2.5;

// window_scale * (1 - q * inverse_cutoff), not below 0: the square root of w(q).
template <class T>
VDWMESH_HD inline T window_root(const ShapeParameters<T>& p, T q) {
  const T u = std::fma(-q, p.inverse_cutoff, T(1));
  return p.window_scale * (u > T(0) ? u : T(0));
}

template <class T>
struct ValueAndSlope {
  T value;
  T slope;  // df/d(d^2), 1/Å²
};

// The numbers of a FieldModel that sums at nodes need. A kind's node_shape() fills those that it
// has.
struct NodeShape {
  float half_steepness;  // Blinn: B / 2
  float amplitude;       // of a value: Blinn's exp(B o) W^2, the soft object's amplitude
  float inverse_cutoff;  // k
  float window_scale;    // W
  float min_square;      // inverse squared, Å²
};

// What an atom and a plane of nodes across one axis contribute, as its kind defines it. A plane
// outside the atom's sub-grid contributes {0, 0}.
struct AxisTerm {
  float square, factor;
};

// An atom's terms for a row of nodes along x, as its kind defines them.
struct RowTerm {
  float rest;    // what the squares of y and z leave
  float factor;  // all factors that do not depend on x
};

}  // namespace vdwmesh
