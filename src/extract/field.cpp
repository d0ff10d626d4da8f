// make_field_model() checks the options of a field, its kind and its preset among them, and turns
// them into numbers. What all kinds of a preset have in common is set here, the rest by the type of
// the kind (field_kinds.hpp). The blended kinds are all but vdw. The presets thesis and thesis_vdw
// reproduce a thesis by Dias; docs/thesis.md says how their numbers were found.
#include "extract/field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"
#include "extract/field_kinds.hpp"

namespace vdwmesh {
namespace {

// Largest accepted blobbiness, the steepness of a Blinn field. The bounds of a field over a block
// of nodes (block_bounds.hpp) allow for the float32 errors up to this steepness.
constexpr double kMostBlobbiness = 50;
// Below this distance from an atom, in grid spacings, the inverse squared field is constant.
constexpr double kClosest = 0.001;

void check_positive(const char* what, const std::optional<double>& value) {
  if (value && !(*value > 0 && std::isfinite(*value))) {
    throw InvalidInput(fmt::format("{} {}: must be finite and above 0", what, *value));
  }
}

void check(const FieldOptions& o) {
  check_positive("isovalue", o.isovalue);
  check_positive("blobbiness", o.blobbiness);
  if (o.blobbiness && *o.blobbiness > kMostBlobbiness) {
    throw InvalidInput(fmt::format("blobbiness {}: at most {}, where float32 still holds the field",
                                   *o.blobbiness, kMostBlobbiness));
  }
  if (o.kind == FieldKind::vdw && (o.isovalue || o.blobbiness)) {
    throw InvalidInput("the vdw field has neither isovalue nor blobbiness; leave them out");
  }
  if (o.kind == FieldKind::vdw && o.preset != FieldPreset::radius_aware) {
    throw InvalidInput(
        "the presets thesis and thesis-vdw are of the fields blinn, soft and inverse-squared");
  }
  if (o.blobbiness && (o.kind != FieldKind::blinn || o.preset != FieldPreset::radius_aware)) {
    throw InvalidInput("blobbiness is of the radius-aware blinn field only; leave it out");
  }
}

// Throws InvalidInput if float32 does not hold the field near the isovalue. A contribution is a
// product of float32 factors, of which largest_factor() is the largest. For an isovalue below
// 2^-100 of it, the product of the others may be 2^-100 too, and 2^-24 of that still counts in a
// sum. This comes near 2^-126, below which float32 loses digits and ends at 0.
void check_isovalue(const FieldModel& m) {
  const double largest =
      with_blended(m.kind, [&]<class Kind>(Kind) { return Kind::largest_factor(m); });
  const double least = std::ldexp(largest, -100);
  const double most = std::numeric_limits<float>::max();
  if (m.isovalue >= least && m.isovalue <= most) return;
  throw InvalidInput(
      fmt::format("isovalue {}: must be from {:.2g} to {:.2g}, where float32 holds "
                  "the field",
                  m.isovalue, least, most));
}

// The model of a radius-aware field, a function of q = (distance / radius)². Members that neither
// this nor the kind sets belong to the other presets. window_scale makes the window 1 at the atom's
// sphere, q = 1.
FieldModel radius_aware(const FieldOptions& o, const GridSpec& grid) {
  constexpr double kCutoff = kWindowRadii * kWindowRadii;  // of q
  FieldModel m{};
  m.kind = o.kind;
  m.truncation = Truncation::window;
  m.isovalue = o.isovalue.value_or(1);
  m.min_square = kClosest * grid.spacing * kClosest * grid.spacing;
  m.inverse_cutoff = 1 / kCutoff;
  m.window_scale = 1 / (1 - 1 / kCutoff);
  m.radius_scale = 1;
  m.grid = grid;
  with_blended(o.kind, [&]<class Kind>(Kind) { Kind::set_radius_aware(o, m); });
  return m;
}

// The model of a field of preset thesis or thesis_vdw. Their sub-grids reach 20 and 4 cells to
// either side of the atom's cell. inverse_cutoff stays 0: there is no window.
FieldModel thesis(const FieldOptions& o, const GridSpec& grid) {
  FieldModel m{};
  m.kind = o.kind;
  m.truncation = Truncation::subgrid;
  m.subgrid_cells = o.preset == FieldPreset::thesis ? 20 : 4;
  m.min_square = kClosest * grid.spacing * kClosest * grid.spacing;
  m.window_scale = 1;
  m.uniform_scale = 1;
  m.most_reach = std::numeric_limits<double>::max();
  m.grid = grid;
  with_blended(o.kind, [&]<class Kind>(Kind) { Kind::set_thesis(o, m); });
  return m;
}

}  // namespace

FieldModel make_field_model(const FieldOptions& options, const GridSpec& grid) {
  check(options);
  if (options.kind == FieldKind::vdw) {
    FieldModel m{};
    m.kind = FieldKind::vdw;
    m.grid = grid;
    return m;
  }
  const FieldModel m = options.preset == FieldPreset::radius_aware ? radius_aware(options, grid)
                                                                   : thesis(options, grid);
  check_isovalue(m);
  return m;
}

GridOptions preset_grid(FieldPreset preset, std::optional<double> spacing,
                        std::optional<double> padding) {
  GridOptions grid;
  if (preset == FieldPreset::radius_aware) {
    grid.spacing = spacing.value_or(0.5);  // Å
    grid.padding = padding;
    return grid;
  }
  grid.spacing = spacing.value_or(0.4);  // Å; with the paddings, from docs/thesis.md
  grid.padding = padding.value_or(preset == FieldPreset::thesis ? 5.0 : 1.2);
  grid.box = GridBox::centers;
  grid.rounding = GridRounding::floor;
  return grid;
}

}  // namespace vdwmesh
