// The cells into which a CellList sorts its spheres, without the spheres.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// One level of a cell list: a regular grid of cells for spheres whose reaches are within a factor
// of two. The reach of a sphere says how far from its centre it matters. A sphere belongs to the
// cell in which its centre lies.
struct CellLevel {
  Vec3d origin;           // lower corner of cell 0, Å
  double cell_size;       // Å
  double reach;           // largest reach of a sphere of the level, plus a bound on rounding, Å
  std::int32_t cells[3];  // number of cells along each axis; all 0 if the level has no spheres

  friend bool operator==(const CellLevel&, const CellLevel&) = default;
};

// The levels for the spheres of a set. Level l takes the spheres whose reach is from 2^l up to
// 2^(l + 1) times smallest_reach. Level 0 also takes smaller reaches, and level
// CellListView::kMaxLevels - 1 all larger ones.
//
// A cell list visits spheres level by level and cell by cell, so its frame decides the order in
// which floating-point sums over spheres run. If two lists of two parts of a set have the same
// frame, they visit the spheres that are in both in the same order. If a sum is over such spheres
// only, its bits are the same with both lists. So processes that hold different parts of a molecule
// get the same field where the parts meet.
struct CellListFrame {
  double smallest_reach = 1;  // Å
  std::vector<CellLevel> levels;

  friend bool operator==(const CellListFrame&, const CellListFrame&) = default;
};

// The frame of a CellList that is made from these spheres without a given frame. `reach[i]` is the
// reach of sphere i (Å, above 0).
CellListFrame make_frame(const SphereSet& spheres, std::span<const double> reach);

}  // namespace vdwmesh
