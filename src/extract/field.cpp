#include "extract/field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/errors.hpp"
#include "extract/blended/field_sample.hpp"

namespace vdwmesh {
namespace {

constexpr double kDefaultBlobbiness = 2;
constexpr double kMostBlobbiness = 50;
// Radius-aware cut-off in units of the radius, squared.
constexpr double kCutoffSquare = 2.5 * 2.5;
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

// The largest number that a product of float32 terms at a node begins with.
double largest_factor(const FieldModel& m) {
  const double peak = std::exp(m.steepness * m.offset) * m.window_scale * m.window_scale;
  return m.kind == FieldKind::blinn ? std::max(1.0, peak) : 1.0;
}

// Below 2^-100 of the largest factor, terms become 0 in float32 that the isovalue would need.
void check_isovalue(const FieldModel& m) {
  const double least = std::ldexp(largest_factor(m), -100);
  const double most = std::numeric_limits<float>::max();
  if (m.isovalue >= least && m.isovalue <= most) return;
  throw InvalidInput(
      fmt::format("isovalue {}: must be from {:.2g} to {:.2g}, where float32 holds "
                  "the field",
                  m.isovalue, least, most));
}

FieldModel radius_aware(const FieldOptions& o, const GridSpec& grid) {
  FieldModel m{};
  m.kind = o.kind;
  m.truncation = Truncation::window;
  m.isovalue = o.isovalue.value_or(1);
  m.steepness = o.blobbiness.value_or(kDefaultBlobbiness);
  m.offset = 1;
  m.amplitude = 2;  // the soft object is 1/2 at half its reach b = 2 R
  m.min_square = kClosest * grid.spacing * kClosest * grid.spacing;
  m.inverse_cutoff = 1 / kCutoffSquare;
  m.window_scale = 1 / (1 - 1 / kCutoffSquare);
  m.radius_scale = o.kind == FieldKind::soft_object ? 0.25 : 1;
  m.grid = grid;
  return m;
}

// Parameters fitted to the triangle counts of the thesis: docs/thesis.md.
FieldModel thesis(const FieldOptions& o, const GridSpec& grid) {
  FieldModel m{};
  m.kind = o.kind;
  m.truncation = Truncation::subgrid;
  m.subgrid_cells = o.preset == FieldPreset::thesis ? 20 : 4;
  m.min_square = kClosest * grid.spacing * kClosest * grid.spacing;
  m.amplitude = 1;
  m.window_scale = 1;
  m.uniform_scale = 1;
  m.grid = grid;
  if (o.kind == FieldKind::blinn) {
    m.steepness = 0.8;
    m.isovalue = o.isovalue.value_or(0.70);
  } else if (o.kind == FieldKind::soft_object) {
    m.uniform_scale = 1 / (1.6 * 1.6);
    m.isovalue = o.isovalue.value_or(0.63);
  } else {
    m.isovalue = o.isovalue.value_or(o.preset == FieldPreset::thesis ? 4.8 : 4.6);
  }
  return m;
}

}  // namespace

FieldModel make_field_model(const FieldOptions& options, const GridSpec& grid) {
  check(options);
  FieldModel m = options.preset == FieldPreset::radius_aware ? radius_aware(options, grid)
                                                             : thesis(options, grid);
  if (m.kind == FieldKind::vdw) {
    m.isovalue = 0;
  } else {
    check_isovalue(m);
  }
  return m;
}

CellList make_field_list(const SphereSet& spheres, const FieldModel& model) {
  std::vector<double> reach(spheres.size());
  for (std::size_t i = 0; i < reach.size(); ++i) reach[i] = field_reach(model, spheres[i].radius);
  return CellList(spheres, reach);
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
