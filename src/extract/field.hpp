// The implicit fields: which function, with which parameters. The formulas themselves are in
// field_formulas.hpp.
#pragma once

#include <cstdint>
#include <optional>

#include "extract/grid.hpp"
#include "spheres/cell_list_frame.hpp"
#include "spheres/sphere_set.hpp"

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
  window,   // smoothly, at q = 1 / inverse_cutoff
  subgrid,  // at the faces of a box of whole grid cells around the atom's cell
};

// A blended field as numbers, trivially copyable. An atom of radius R adds f(q), q = d^2 * s, where
// s is 1/R^2 or its like; blended/blinn.hpp and its neighbours have the formulas. A sub-grid has no
// window (inverse_cutoff = 0, window_scale = 1): f is 0 outside the atom's box of grid cells.
struct FieldModel {
  FieldKind kind;
  Truncation truncation;
  double isovalue;
  double steepness, offset;             // Blinn
  double amplitude;                     // soft object
  double min_square;                    // inverse squared, Å²
  double inverse_cutoff, window_scale;  // w
  double uniform_scale;                 // s of every atom, 1/Å²; 0: s = radius_scale / R²
  double radius_scale;
  double reach_radii;          // with a window: f ends so many radii from the centre
  double most_reach;           // with a sub-grid: f ends there if the box does not end before, Å
  std::int32_t subgrid_cells;  // cells on either side of the atom's own
  GridSpec grid;               // of the sub-grid
};

// Throws InvalidInput for an isovalue or blobbiness that is not finite and positive or beyond what
// float32 holds, for either of them with FieldKind::vdw, and for a thesis preset with
// FieldKind::vdw.
FieldModel make_field_model(const FieldOptions& options, const GridSpec& grid);

// The frame of the cell list in which the field is summed. Extractions of parts of a set that are
// given the frame of the whole set compute the same field where the parts meet, bit for bit.
CellListFrame make_field_frame(const SphereSet& spheres, const FieldModel& model);

// The grid the preset asks for, where the caller leaves spacing, padding or both unset. Å.
GridOptions preset_grid(FieldPreset preset, std::optional<double> spacing,
                        std::optional<double> padding);

}  // namespace vdwmesh
