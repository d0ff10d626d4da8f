// make_field_model() checks the options of a field and turns them into numbers: what the kinds of a
// preset share is set here, the rest by the kind itself (field_kinds.hpp). preset_grid() knows the
// spacings and paddings of the presets.
#include "extract/field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"
#include "extract/field_kinds.hpp"

namespace vdwmesh {
namespace {

constexpr double kMostBlobbiness = 50;
// Closest distance of the inverse squared field, in grid spacings.
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
    throw InvalidInput("the thesis presets are of the fields blinn, soft and inverse-squared");
  }
  if (o.blobbiness && (o.kind != FieldKind::blinn || o.preset != FieldPreset::radius_aware)) {
    throw InvalidInput("blobbiness is of the radius-aware blinn field only; leave it out");
  }
}

// Below 2^-100 of the largest factor, terms become 0 in float32 that the isovalue would need.
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

// What all kinds of a preset have in common; the kind sets the rest.
FieldModel radius_aware(const FieldOptions& o, const GridSpec& grid) {
  constexpr double kCutoffSquare = kWindowRadii * kWindowRadii;
  FieldModel m{};
  m.kind = o.kind;
  m.truncation = Truncation::window;
  m.isovalue = o.isovalue.value_or(1);
  m.min_square = kClosest * grid.spacing * kClosest * grid.spacing;
  m.inverse_cutoff = 1 / kCutoffSquare;
  m.window_scale = 1 / (1 - 1 / kCutoffSquare);
  m.radius_scale = 1;
  m.grid = grid;
  with_blended(o.kind, [&]<class Kind>(Kind) { Kind::set_radius_aware(o, m); });
  return m;
}

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
    grid.spacing = spacing.value_or(0.5);
    grid.padding = padding;
    return grid;
  }
  grid.spacing = spacing.value_or(0.4);
  grid.padding = padding.value_or(preset == FieldPreset::thesis ? 5.0 : 1.2);
  grid.box = GridBox::centers;
  grid.rounding = GridRounding::floor;
  return grid;
}

}  // namespace vdwmesh
