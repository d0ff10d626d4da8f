// Area and volume of the solvent-excluded solid by counting, straight from its definition: a slow
// oracle with an error of its own, without any formula for the surface.
//
// Cells of an octree are decided whole by the distance of their middles (`AccessibleDistance`),
// which changes by no more than the point moves. What the surface may pass through is sampled:
//
// Volume. Two random points in every small cell tell whether they are in the solid.
//
// Area. A random line along axis k through a column of cells of edge e meets the surface so that
// e² Σ |n_k| over the crossings has the mean ∫ n_k² dA, with the unit normal n, which points to the
// nearest accessible point. As n_x² + n_y² + n_z² = 1, the three axes together give the area.
//
// Shares of atoms. A crossing belongs to the atom that the probe at the nearest accessible point
// touches; of two, to the one whose grown ball has less power there; of more, to the one that is
// touched nearest to the crossing.
//
// All means are exact, whatever the cells' sizes. Every cell and every column is sampled twice,
// independently, and half the differences squared sum up to the variance.
#pragma once

#include <array>
#include <vector>

#include "reference/accessible_distance.hpp"

namespace vdwmesh::reference {

struct Estimate {
  double value = 0, variance = 0;
  double standard_error() const { return std::sqrt(variance); }
};

struct ExcludedGridOptions {
  double line_cell;   // Å: edge of the cells in which lines are drawn
  int halvings = 2;   // from there to the cells in which points are counted; at least 1
  unsigned seed = 1;  // of the random points and lines
};

struct ExcludedEstimates {
  Estimate volume;                    // Å³
  Estimate area;                      // Å²
  Estimate contact, saddle, concave;  // Å²: the parts of the area
  std::vector<Estimate> atom_area;    // Å², in the order of the atoms
};

// The complete surface, cavities included. Preconditions: those of AccessibleDistance; the probe is
// above 0.
ExcludedEstimates excluded_grid(const std::vector<Ball>& atoms, double probe,
                                const ExcludedGridOptions& options);

}  // namespace vdwmesh::reference
