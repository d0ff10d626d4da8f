// The kinds of field as types, and the one place that goes from a FieldKind, known at run time, to
// its type. Templates over the type then compile every loop once per kind, without a branch on it.
//
// A blended field is a type with static functions only, like Blinn in blended/blinn.hpp; the
// concept BlendedKind lists them. A new kind needs a header with its type, a name in FieldKind, and
// a case in with_blended(); the compiler warns if a switch lacks a name.
#pragma once

#include <concepts>

#include "core/host_device.hpp"
#include "extract/blended/blinn.hpp"
#include "extract/blended/inverse_squared.hpp"
#include "extract/blended/soft_object.hpp"
#include "extract/field.hpp"

namespace vdwmesh {

// What a kind of blended field defines, for the contribution f of one atom:
// - f and its slope by the squared distance, in float or double: value(), value_and_slope(), and
//   reaches(q), which is false only if f at q is exactly 0.
// - What bounds on f over a box may assume: is_convex_beyond(d2) says whether f as a function of
//   d^2 is convex from d2 on, and absolute_rounding() bounds the part of the float32 error that is
//   not relative to f.
// - The same f at the nodes of a grid, in float32, from terms of one axis each: node_shape() makes
//   the parameters, axis_term() the term of a plane, row_term() combines y and z,
//   row_is_out_of_reach() is true only if the atom adds exactly 0 to the whole row, and add_atom()
//   returns a sum plus f at one node of the row.
// - The parameters of its presets: set_radius_aware() and set_thesis() set members of the
//   FieldModel. largest_factor() gives the smallest isovalue that float32 can hold (field.cpp).
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

// Tag of the union of balls. It is not a sum over atoms, so it is no BlendedKind; its formulas are
// in union/ and in blended/edge_formulas.hpp.
struct UnionOfBalls {};

// Returns f(Kind{}) with the type of the kind. Precondition: kind is not vdw.
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

// with_blended() for every kind: for vdw it returns f(UnionOfBalls{}).
template <class F>
VDWMESH_HD decltype(auto) with_kind(FieldKind kind, F&& f) {
  return kind == FieldKind::vdw ? f(UnionOfBalls{}) : with_blended(kind, f);
}

}  // namespace vdwmesh
