// CASTp's sums over the simplices of a tetrahedron: for the library's own use.
#pragma once

#include <array>

#include "complex/dual_complex.hpp"

namespace vdwmesh {

// Inclusion–exclusion with inner angles over the simplices of the dual complex at one tetrahedron
// outside it (Liang et al. 1998). Lengths are scaled as in the triangulation. Entry k of the arrays
// belongs to the face opposite to vertex k; only faces outside the complex have entries.
struct CastpSums {
  double volume = 0, area = 0;
  std::array<double, 4> face_area{}, face_rim{};
};

CastpSums castp_sums(const PowerTriangulation& triangulation, const DualComplex& complex,
                     std::uint32_t cell);

// The number of the edge of the complex between two balls; kNoIndex: there is none.
std::uint32_t dual_edge(const DualComplex& complex, std::uint32_t a, std::uint32_t b);

}  // namespace vdwmesh
