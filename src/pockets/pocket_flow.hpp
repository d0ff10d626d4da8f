// The discrete flow of empty tetrahedra, and the pockets that it leaves. For the library's own use.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "complex/dual_complex.hpp"

namespace vdwmesh {

// Bit k of a cell's mask belongs to the face opposite to vertex k. Cells with an auxiliary vertex
// stand for infinity; they are outside.
struct PocketFlow {
  std::vector<std::uint8_t> obtuse;   // per cell: faces beyond which its orthogonal centre lies
  std::vector<std::uint32_t> pocket;  // per cell: number of its pocket; kNoIndex: in none
  std::uint32_t pockets = 0;          // numbered by their lowest cells
  std::vector<std::uint32_t> cells;   // those in pockets, ascending
  std::uint64_t empty_cells = 0, face_ties = 0, cell_ties = 0;  // as in PocketTable
};

PocketFlow pocket_flow(const PowerTriangulation& triangulation, const DualComplex& complex,
                       Monitor* monitor);

// Whether a cell has balls at all its vertices.
bool is_finite_cell(const PowerTriangulation& triangulation, std::uint32_t cell);

// The widest ways from infinity to cells: for each, the largest alpha (scaled as the triangulation
// is) such that no face on the way is smaller. A face has the size of its smallest orthogonal
// sphere, or that of the smaller of its two cells if the sphere conflicts with one of them.
class WidestWays {
 public:
  // Finds the ways to these cells, which are in no particular order.
  WidestWays(const PowerTriangulation& triangulation, const std::vector<std::uint8_t>& obtuse,
             const std::vector<std::uint32_t>& wanted, Monitor* monitor);
  double alpha(std::uint32_t cell) const { return alpha_[cell]; }

 private:
  std::vector<double> alpha_;  // per cell that was reached
};

// The size of a cell of balls, and of its face opposite to vertex k.
double cell_alpha(const PowerTriangulation& triangulation, std::uint32_t cell);
double face_alpha(const PowerTriangulation& triangulation, std::uint32_t cell, std::size_t k);

}  // namespace vdwmesh
