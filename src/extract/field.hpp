// The implicit fields whose level set is the surface: which function, with which parameters. The
// formulas themselves are in blended/ and union/.
#pragma once

#include <cstdint>
#include <optional>

#include "extract/grid.hpp"
#include "spheres/cell_list_frame.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// vdw: the union of the balls. The others are blended fields: the contributions f_i of all atoms
// are summed, F(p) = sum of f_i(p), and a point p is inside if F(p) >= T, the isovalue.
enum class FieldKind : std::uint8_t { vdw, blinn, soft_object, inverse_squared };

// radius_aware: the isosurface of an isolated atom, for the default isovalue, is its sphere.
// thesis, thesis_vdw: all atoms have the same size, whatever their radii, with parameters that are
// fitted to Tables 4.1-4.3 and 4.4-4.5 of the thesis (docs/thesis.md).
enum class FieldPreset : std::uint8_t { radius_aware, thesis, thesis_vdw };

struct FieldOptions {
  FieldKind kind = FieldKind::vdw;
  FieldPreset preset = FieldPreset::radius_aware;
  // T of the blended fields. If it is unset, the preset decides: 1 for radius_aware, else the
  // fitted isovalue of the kind.
  std::optional<double> isovalue;
  std::optional<double> blobbiness;  // B, the steepness of radius-aware Blinn; unset: 2
};

// How an atom's contribution ends.
enum class Truncation : std::uint8_t {
  window,   // smoothly, at q = 1 / inverse_cutoff
  subgrid,  // at the faces of a box of whole grid cells around the atom's cell
};

// A field as numbers, trivially copyable. For vdw only `kind` and `grid` have a meaning; the other
// members are for blended fields. An atom of radius R contributes f(q) with q = s d^2, where d is
// the distance from its centre and s its scale; blended/blinn.hpp and its neighbours have the
// formulas. A field with sub-grids has no window (inverse_cutoff = 0, window_scale = 1): f is 0
// outside the atom's box of grid cells.
struct FieldModel {
  FieldKind kind;
  Truncation truncation;
  double isovalue;
  double steepness, offset;             // Blinn: B and o
  double amplitude;                     // soft object: A
  double min_square;                    // inverse squared: smaller d^2 are replaced by it, Å²
  double inverse_cutoff, window_scale;  // k and W of the window; k = 0: no window
  double uniform_scale;                 // s of every atom, 1/Å²; 0: s = radius_scale / R²
  double radius_scale;                  // used if uniform_scale is 0
  double reach_radii;          // with a window: f ends at this distance from the centre, in radii
  double most_reach;           // with sub-grids: f ends here if the box does not end before, Å
  std::int32_t subgrid_cells;  // with sub-grids: cells of the box on either side of the atom's cell
  GridSpec grid;               // the grid that is meshed; sub-grids consist of its cells
};

// Turns the options into numbers. Throws InvalidInput in these cases: an isovalue or a blobbiness
// that is not finite and above 0, or so large or small that float32 does not hold the field; a
// blobbiness for another field than radius-aware Blinn; an isovalue or a thesis preset for vdw.
FieldModel make_field_model(const FieldOptions& options, const GridSpec& grid);

// The frame of the cell list over which the field is summed: it decides the order of the sums.
// Extractions of parts of a set that are all given the frame of the whole set compute the same
// field where the parts meet, bit for bit.
CellListFrame make_field_frame(const SphereSet& spheres, const FieldModel& model);

// Grid options for a preset. A spacing or padding (Å) that is unset gets the preset's value; for
// radius_aware, an unset padding stays unset.
GridOptions preset_grid(FieldPreset preset, std::optional<double> spacing,
                        std::optional<double> padding);

}  // namespace vdwmesh
