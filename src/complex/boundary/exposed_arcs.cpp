// exposed_arcs(): walks around the edges of the dual complex.
//
// The cells around an edge correspond to the turn about its circle. A run of cells outside the
// complex, between two triangles of the complex, is one exposed arc: it starts at a corner of the
// first triangle and ends at one of the second. An edge without triangles is exposed all around.
#include "complex/boundary/exposed_arcs.hpp"

#include <algorithm>

#include "core/fixed_blocks.hpp"
#include "core/order/sorted_rows.hpp"

namespace vdwmesh {
namespace {

// Turns about edge ab, which is edge k of triangle f, from the cell on the given side of f. This
// cell is outside the complex. Returns the corner at which the arc ends: on the next triangle of
// the complex, on the side of the walk's last cell. A cell is entered by the facet with the
// vertices a, b and `from`, and left by the facet opposite to `from`.
CornerIndex next_corner(const PowerTriangulation& t, const DualComplex& complex,
                        const DualTriangle& f, std::size_t k, std::size_t side) {
  const std::uint32_t a = f.vertices[(k + 1) % 3], b = f.vertices[(k + 2) % 3];
  std::uint32_t from = f.vertices[k], cell = f.cells[side];
  for (;;) {
    const auto& v = t.cells[cell];
    const auto exit = static_cast<std::size_t>(std::find(v.begin(), v.end(), from) - v.begin());
    const std::uint32_t found = complex.cell_triangles[cell][exit];
    if (found != kNoIndex) {
      return 2 * CornerIndex{found} + (complex.triangles[found].cells[0] == cell ? 0 : 1);
    }
    // The cell's fourth vertex, beside a, b and `from`, is on the facet to the next cell.
    from = *std::find_if(v.begin(), v.end(),
                         [&](std::uint32_t w) { return w != a && w != b && w != from; });
    cell = t.neighbors[cell][exit];
  }
}

// The vertex of a triangle that is not on its edge.
std::uint32_t apex(const DualTriangle& f, std::uint32_t edge) {
  return f.vertices[f.edges[0] == edge ? 0 : (f.edges[1] == edge ? 1 : 2)];
}

}  // namespace

// Walks through the cells of the complex around the edge, from the triangle at which the arc ends
// to the triangle at which the next arc begins. All facets of these cells are in the complex. If
// there are no such cells, the triangle is exposed on both sides, and the next arc begins at its
// other corner.
CornerIndex next_start(const PowerTriangulation& t, const DualComplex& complex, std::uint32_t edge,
                       CornerIndex end) {
  std::uint64_t triangle = end / 2;
  std::size_t side = 1 - end % 2;
  while (!complex.triangles[triangle].exposed[side]) {
    const DualTriangle& f = complex.triangles[triangle];
    const std::uint32_t cell = f.cells[side];
    const auto& v = t.cells[cell];
    const auto exit =
        static_cast<std::size_t>(std::find(v.begin(), v.end(), apex(f, edge)) - v.begin());
    triangle = complex.cell_triangles[cell][exit];
    side = complex.triangles[triangle].cells[0] == cell ? 1 : 0;
  }
  return 2 * triangle + side;
}

std::vector<ExposedArc> exposed_arcs(const PowerTriangulation& triangulation,
                                     const DualComplex& complex) {
  std::vector<ExposedArc> arcs;
  for (std::uint32_t e = 0; e < complex.edges.size(); ++e) {
    if (complex.edges[e].singular) arcs.push_back({e, kNoCorner, kNoCorner});
  }
  const std::vector<ExposedArc> with_corners = collect<ExposedArc>(
      complex.triangles.size(), [&](std::size_t i, std::vector<ExposedArc>& found) {
        const DualTriangle& f = complex.triangles[i];
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t side = leading_side(f, k);
          if (!f.exposed[side]) continue;
          found.push_back({f.edges[k], 2 * CornerIndex{i} + side,
                           next_corner(triangulation, complex, f, k, side)});
        }
      });
  arcs.insert(arcs.end(), with_corners.begin(), with_corners.end());
  SortedRows<ExposedArc> sorted;  // by the lower ball
  sorted.fill(triangulation.balls.size(), arcs.size(), [&](std::size_t i, const auto& add) {
    add(complex.edges[arcs[i].edge].vertices[0], arcs[i]);
  });
  std::ranges::copy(sorted.entries(), arcs.begin());
  return arcs;
}

}  // namespace vdwmesh
