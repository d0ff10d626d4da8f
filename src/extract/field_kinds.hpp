// The kinds of field as types, and the one place that goes from a FieldKind to its type.
//
// A blended field is a type like Blinn (blended/blinn.hpp): its value and slope by the squared
// distance, its terms at the nodes of a grid, what its bounds may assume, and the parameters of its
// presets; BlendedKind lists them. A new one needs its header, its name in FieldKind, and its line
// in with_blended(): the compiler warns where a switch lacks a name.
#pragma once

#include <concepts>

#include "core/host_device.hpp"
#include "extract/blended/blinn.hpp"
#include "extract/blended/inverse_squared.hpp"
#include "extract/blended/soft_object.hpp"
#include "extract/field.hpp"

namespace vdwmesh {

template <class Kind>
concept BlendedKind = requires(const ShapeParameters<double>& shape, const NodeShape& nodes,
                               const AxisTerm& axis, const RowTerm& row, const FieldModel& model,
                               FieldModel& made, const FieldOptions& options) {
  { Kind::reaches(shape, 0.0) } -> std::same_as<bool>;
  { Kind::value(shape, 0.0, 1.0) } -> std::same_as<double>;
  { Kind::value_and_slope(shape, 0.0, 1.0) } -> std::same_as<ValueAndSlope<double>>;
  { Kind::is_convex_beyond(shape, 0.0) } -> std::same_as<bool>;
  { Kind::absolute_rounding(shape) } -> std::same_as<double>;
  { Kind::node_shape(model) } -> std::same_as<NodeShape>;
  { Kind::axis_term(nodes, 1.0f, 0, 0.0f) } -> std::same_as<AxisTerm>;
  { Kind::row_term(nodes, axis, axis) } -> std::same_as<RowTerm>;
  { Kind::row_is_out_of_reach(nodes, row) } -> std::same_as<bool>;
  { Kind::add_atom(nodes, row, axis, 1.0f, 0.0f) } -> std::same_as<float>;
  { Kind::largest_factor(model) } -> std::same_as<double>;
  Kind::set_radius_aware(options, made);
  Kind::set_thesis(options, made);
};

// The union of the balls, which is no sum over atoms: its formulas are in union/.
struct UnionOfBalls {};

// f(Kind{}) with the type of the kind. Precondition: it is not vdw.
template <class F>
VDWMESH_HD decltype(auto) with_blended(FieldKind kind, F&& f) {
  switch (kind) {
    case FieldKind::blinn:
      return f(Blinn{});
    case FieldKind::soft_object:
      return f(SoftObject{});
    case FieldKind::inverse_squared:
      return f(InverseSquared{});
    case FieldKind::vdw:
      break;
  }
  __builtin_unreachable();
}

// The same for every kind; f(UnionOfBalls{}) for vdw.
template <class F>
VDWMESH_HD decltype(auto) with_kind(FieldKind kind, F&& f) {
  return kind == FieldKind::vdw ? f(UnionOfBalls{}) : with_blended(kind, f);
}

}  // namespace vdwmesh
