// The cells that a CellList sorts its spheres into, apart from the spheres themselves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// A regular grid of cells for the spheres of like reach. A sphere is in the cell of its centre.
struct CellLevel {
  Vec3d origin;           // lower corner of cell 0, Å
  double cell_size;       // Å
  double reach;           // largest reach that the level takes, and what rounding adds to it, Å
  std::int32_t cells[3];  // along each axis; all 0 where no sphere has such a reach

  friend bool operator==(const CellLevel&, const CellLevel&) = default;
};

// Cells for the spheres of a set, level by level: level l takes the reaches from 2^l times the
// smallest up to twice that, and the last level takes all that are larger.
//
// A cell list visits spheres level by level and cell by cell, so its frame decides the order in
// which floating-point sums over spheres run. Two lists with one frame, over two parts of a set,
// visit the spheres that both have in the same order, and their sums agree to the last bit. That is
// how processes that hold different parts of a molecule get the same field where the parts meet.
struct CellListFrame {
  double smallest_reach = 1;  // Å
  std::vector<CellLevel> levels;

  friend bool operator==(const CellListFrame&, const CellListFrame&) = default;
};

// The frame that a CellList over these spheres gives itself. `reach[i]` (Å, above 0): how far from
// its centre sphere i matters.
CellListFrame make_frame(const SphereSet& spheres, std::span<const double> reach);

}  // namespace vdwmesh
