// The implicit fields: which function, with which parameters. The formulas themselves are in
// field_formulas.hpp.
#pragma once

#include <cstdint>
#include <optional>

#include "extract/grid.hpp"
#include "extract/sphere_set.hpp"

namespace vdwmesh {

// vdw: the union of the balls. The others are blended: F(p) = sum of f_i(p), inside where F >= T.
enum class FieldKind : std::uint8_t { vdw, blinn, soft_object, inverse_squared };

// radius_aware: an isolated atom's isosurface is its sphere. thesis, thesis_vdw: one blob size for
// all atoms, as fitted to Dias's Tables 4.1-4.3 and 4.4-4.5.
enum class FieldPreset : std::uint8_t { radius_aware, thesis, thesis_vdw };

struct FieldOptions {
  FieldKind kind = FieldKind::vdw;
  FieldPreset preset = FieldPreset::radius_aware;
  std::optional<double> isovalue;    // T of the blended fields; unset: the preset's (1, or fitted)
  std::optional<double> blobbiness;  // B of radius-aware Blinn; unset: 2
};

// How an atom's contribution ends.
enum class Truncation : std::uint8_t {
  window,   // smoothly, at cutoff_q
  subgrid,  // at the faces of a box of whole grid cells around the atom's cell
};

// A blended field as numbers, trivially copyable. With q = d^2 * inverse_square_scale of the atom
// (1/R^2 radius-aware, a constant in the thesis presets):
//   Blinn            f = exp(steepness * (offset - q)) * w(q)
//   soft object      f = amplitude * (1 - 22/9 q + 17/9 q^2 - 4/9 q^3)   for q < 1, else 0
//   inverse squared  f = w(q) / max(q, min_q)
// with w(q) = ((1 - q / cutoff_q) * window_scale)^2 for q < cutoff_q, else 0 (Truncation::window);
// w = 1 inside the sub-grid box, else 0 (Truncation::subgrid).
struct FieldModel {
  FieldKind kind;
  Truncation truncation;
  double isovalue;
  double steepness, offset;       // Blinn
  double amplitude;               // soft object
  double min_q;                   // inverse squared
  double cutoff_q, window_scale;  // window
  double uniform_scale;           // inverse_square_scale of every atom, 1/Å^2; 0: it is k / R^2
  double radius_scale;            // k
  std::int32_t subgrid_cells;     // half-width of the sub-grid, cells on either side of the atom's
  GridSpec grid;                  // of the sub-grid
};

// Throws InvalidInput for an isovalue or blobbiness that is not finite and positive, for either of
// them with FieldKind::vdw, and for a thesis preset with FieldKind::vdw.
FieldModel make_field_model(const FieldOptions& options, const GridSpec& grid);

// How far from its centre the sphere matters: its radius for vdw, else where f_i ends (along an
// axis, for a sub-grid). Å.
double field_reach(const FieldModel& model, double radius);

// The grid the preset asks for, where the caller leaves spacing, padding or both unset. Å.
GridOptions preset_grid(FieldPreset preset, std::optional<double> spacing,
                        std::optional<double> padding);

}  // namespace vdwmesh
