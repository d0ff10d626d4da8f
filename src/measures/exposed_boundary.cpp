// exposed_boundary(): numbers the corners and arcs of a dual complex. The triangles and edges of
// the complex stand in the order of their balls, so the corners and arcs do as well.
//
// 1. Each exposed side of a triangle is a corner. Side s of triangle f has the CornerIndex 2 f + s;
//    the exposed ones are numbered without gaps.
// 2. exposed_arcs() names the ends of arcs by CornerIndex. They get these numbers.
// 3. Each edge of the complex makes its two balls neighbours.
#include "measures/exposed_boundary.hpp"

#include <utility>

#include "complex/boundary/exposed_arcs.hpp"
#include "complex/dual_complex.hpp"
#include "core/fixed_blocks.hpp"
#include "core/order/sorted_rows.hpp"
#include "measures/measures.hpp"

namespace vdwmesh {
namespace {

void list_neighbors(const DualComplex& complex, std::size_t balls, ExposedBoundary& out) {
  SortedRows<std::uint32_t> rows;
  rows.fill(balls, complex.edges.size(), [&](std::size_t e, const auto& add) {
    const auto [a, b] = complex.edges[e].vertices;
    add(a, b);
    add(b, a);
  });
  out.neighbor_lists.assign(rows.entries().begin(), rows.entries().end());
  out.first_neighbor.assign(1, 0);
  for (std::size_t b = 0; b < balls; ++b) {
    out.first_neighbor.push_back(out.first_neighbor.back() + std::as_const(rows)[b].size());
  }
}

}  // namespace

ExposedBoundary exposed_boundary(const PowerTriangulation& triangulation,
                                 const DualComplex& complex) {
  ExposedBoundary out;
  std::vector<std::uint32_t> number(2 * complex.triangles.size(), kNoIndex);  // by CornerIndex
  out.corners.resize(number_all(
      number.size(),
      [&](CornerIndex index) { return complex.triangles[index / 2].exposed[index % 2]; },
      [&](CornerIndex index, std::uint32_t n) { number[index] = n; }));
  for_each_index(number.size(), [&](CornerIndex index) {
    if (number[index] == kNoIndex) return;
    out.corners[number[index]] = {complex.triangles[index / 2].vertices,
                                  static_cast<std::uint32_t>(index % 2)};
  });
  const auto number_of = [&](CornerIndex corner) {
    return corner == kNoCorner ? kNoIndex : number[corner];
  };
  const std::vector<ExposedArc> arcs = exposed_arcs(triangulation, complex);
  out.arcs.resize(arcs.size());
  for_each_index(arcs.size(), [&](std::size_t i) {
    const auto& [edge, start, end] = arcs[i];
    out.arcs[i] = {complex.edges[edge].vertices, {number_of(start), number_of(end)}};
  });
  list_neighbors(complex, triangulation.balls.size(), out);
  out.areas = exposed_areas(triangulation, complex);
  return out;
}

}  // namespace vdwmesh
