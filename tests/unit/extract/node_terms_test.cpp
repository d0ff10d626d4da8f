// Node values as products of terms of one axis, against the reference's equations in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "extract/blended/field_formulas.hpp"
#include "extract/field_kinds.hpp"
#include "reference/field_oracle.hpp"

namespace vdwmesh {
namespace {

constexpr double kUnit = 1.0 / (1 << 24);  // relative rounding of float32

constexpr double kSpacing = 0.5;  // Å

FieldModel model_of(FieldKind kind, double blobbiness) {
  FieldOptions options;
  options.kind = kind;
  if (kind == FieldKind::blinn) options.blobbiness = blobbiness;
  return make_field_model(options, {{0, 0, 0}, kSpacing, {10, 10, 10}});
}

template <BlendedKind Kind>
float at_node(const FieldModel& m, double radius, const Vec3d& offset) {
  const NodeShape p = Kind::node_shape(m);
  const auto scale = static_cast<float>(inverse_square_scale(m, radius));
  AxisTerm term[3];
  for (int axis = 0; axis < 3; ++axis) {
    term[axis] = Kind::axis_term(p, scale, axis, static_cast<float>(offset[axis]));
  }
  return Kind::add_atom(p, Kind::row_term(p, term[1], term[2]), term[0], scale, 0.0f);
}

// What the reference's equation gives for an atom at the origin.
double exactly(FieldKind kind, double blobbiness, double radius, const Vec3d& offset) {
  reference::FieldOracle oracle;
  oracle.function = kind == FieldKind::blinn         ? reference::Function::blinn
                    : kind == FieldKind::soft_object ? reference::Function::soft_object
                                                     : reference::Function::inverse_squared;
  oracle.lattice.spacing = kSpacing;
  oracle.blobbiness = blobbiness;
  return reference::contribution(oracle, {{0, 0, 0}, radius}, {offset.x, offset.y, offset.z});
}

class Offsets {
 public:
  Vec3d next() { return {place_(random_), place_(random_), place_(random_)}; }

 private:
  std::mt19937_64 random_{7};
  std::uniform_real_distribution<double> place_{-3.0, 3.0};
};

// Units of rounding: the exponent of each g carries 4 of its own size, B q / 2, doubled by the
// square; the three exponentials 7 each, doubled; products 10. The root of the window loses 4 g of
// what is left of 1, which the square doubles.
double blinn_bound(const FieldModel& m, double radius, const Vec3d& offset) {
  const double q = squared_norm(offset) * inverse_square_scale(m, radius);
  const double peak = std::exp(m.steepness * (m.offset - q)) * m.window_scale * m.window_scale;
  const double root = std::max(0.0, 1 - q * m.inverse_cutoff);
  return kUnit * peak * ((4 * m.steepness * q + 52) * root * root + 8 * root) +
         16 * kUnit * kUnit * peak;
}

TEST(NodeTerms, BlinnIsWithinItsRoundings) {
  for (const double blobbiness : {0.5, 2.0, 8.0}) {
    const FieldModel m = model_of(FieldKind::blinn, blobbiness);
    Offsets offsets;
    for (int i = 0; i < 20000; ++i) {
      const Vec3d offset = offsets.next();
      const double error = std::abs(static_cast<double>(at_node<Blinn>(m, 1.7, offset)) -
                                    exactly(FieldKind::blinn, blobbiness, 1.7, offset));
      ASSERT_LE(error, blinn_bound(m, 1.7, offset)) << offset.x << ' ' << offset.y;
    }
  }
}

// Polynomial and quotient of q, which is good to 6 units; both fall by less than 3 f per unit of q
// over q, or 22/9 in all.
TEST(NodeTerms, SoftObjectAndInverseSquaredAreWithinTheirRoundings) {
  const FieldModel soft = model_of(FieldKind::soft_object, 0);
  const FieldModel inverse = model_of(FieldKind::inverse_squared, 0);
  Offsets offsets;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d offset = offsets.next();
    const double s = exactly(FieldKind::soft_object, 0, 1.7, offset);
    ASSERT_NEAR(at_node<SoftObject>(soft, 1.7, offset), s, 2 * 6 * 5 * kUnit);
    const double v = exactly(FieldKind::inverse_squared, 0, 1.7, offset);
    ASSERT_NEAR(at_node<InverseSquared>(inverse, 1.7, offset), v, 20 * kUnit * v + 20 * kUnit);
  }
}

// The quotient stops growing at min_square, whatever the radius.
TEST(NodeTerms, InverseSquaredIsCappedAboutTheCentre) {
  const FieldModel m = model_of(FieldKind::inverse_squared, 0);
  Offsets offsets;
  for (const double radius : {0.7, 1.7}) {
    for (int i = 0; i < 2000; ++i) {
      const Vec3d offset = std::sqrt(m.min_square) / 3 * offsets.next();  // most of them inside
      const double v = exactly(FieldKind::inverse_squared, 0, radius, offset);
      ASSERT_NEAR(at_node<InverseSquared>(m, radius, offset), v, 20 * kUnit * v);
    }
  }
}

TEST(NodeTerms, NothingBeyondTheReach) {
  const double radius = 1.7;
  for (const FieldKind kind :
       {FieldKind::blinn, FieldKind::soft_object, FieldKind::inverse_squared}) {
    const FieldModel m = model_of(kind, 2);
    const double reach = field_reach(m, radius);
    Offsets offsets;
    for (int i = 0; i < 2000; ++i) {
      Vec3d offset = offsets.next();
      offset = (reach / norm(offset)) * offset;
      const float value =
          with_blended(kind, [&]<class Kind>(Kind) { return at_node<Kind>(m, radius, offset); });
      ASSERT_EQ(value, 0.0f);
    }
  }
}

}  // namespace
}  // namespace vdwmesh
