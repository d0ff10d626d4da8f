// cgal_cells(): insertion into CGAL's regular triangulation, flattened into arrays. The power test
// is power_side(), which squares radii exactly; CGAL's own takes weights, that is, squared radii
// that were rounded to double.
#include "cgal_cells.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_3.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <cassert>

#include "complex/placed_balls.hpp"
#include "complex/power_predicates.hpp"
#include "core/no_index.hpp"

namespace vdwmesh::testing {
namespace {

// The geometric traits of the triangulation. A weighted point carries the radius as its weight, and
// the power test squares it exactly.
struct PowerTraits : CGAL::Epick {
  struct Power_side_of_oriented_power_sphere_3 {
    using result_type = CGAL::Oriented_side;
    using P = Weighted_point_3;

    static Sphere sphere(const P& p) { return {{p.x(), p.y(), p.z()}, p.weight()}; }

    result_type operator()(const P& p, const P& q, const P& r, const P& s, const P& t) const {
      return static_cast<result_type>(
          power_side(sphere(p), sphere(q), sphere(r), sphere(s), sphere(t)));
    }
    // Tests among two to four points in a lower dimension. The auxiliary points come first and make
    // the triangulation three-dimensional, so these tests are never asked for.
    result_type operator()(const P&, const P&) const { return unreachable(); }
    result_type operator()(const P&, const P&, const P&) const { return unreachable(); }
    result_type operator()(const P&, const P&, const P&, const P&) const { return unreachable(); }

    static result_type unreachable() {
      assert(!"a degenerate power test cannot occur");
      return CGAL::ON_ORIENTED_BOUNDARY;
    }
  };
  Power_side_of_oriented_power_sphere_3 power_side_of_oriented_power_sphere_3_object() const {
    return {};
  }
};

using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<
    std::uint32_t, PowerTraits, CGAL::Regular_triangulation_vertex_base_3<PowerTraits>>;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<std::uint32_t, PowerTraits,
                                              CGAL::Regular_triangulation_cell_base_3<PowerTraits>>;
using Triangulation =
    CGAL::Regular_triangulation_3<PowerTraits,
                                  CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;

// A ball that others hide has no vertex: insert() returns an empty handle.
void insert(Triangulation& triangulation, const Vec3d& c, double radius, std::size_t index) {
  const auto vertex = triangulation.insert(PowerTraits::Weighted_point_3({c.x, c.y, c.z}, radius));
  if (vertex != Triangulation::Vertex_handle()) vertex->info() = static_cast<std::uint32_t>(index);
}

// CGAL's order is positively oriented.
CellVertices vertices_of(const Triangulation::Cell& cell) {
  return canonical({cell.vertex(0)->info(), cell.vertex(1)->info(), cell.vertex(2)->info(),
                    cell.vertex(3)->info()});
}

}  // namespace

RegularCells cgal_cells(const std::vector<Sphere>& balls, const std::array<Vec3d, 4>& auxiliary,
                        const TakesCell& takes, std::vector<std::uint8_t>& has_vertex) {
  Triangulation triangulation;
  for (std::size_t k = 0; k < 4; ++k) insert(triangulation, auxiliary[k], 0, balls.size() + k);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    insert(triangulation, balls[i].center, balls[i].radius, i);
  }
  for (const auto vertex : triangulation.finite_vertex_handles()) {
    if (vertex->info() < balls.size()) has_vertex[vertex->info()] = 1;
  }
  RegularCells out;
  for (const auto cell : triangulation.all_cell_handles()) cell->info() = kNoIndex;
  for (const auto cell : triangulation.finite_cell_handles()) {
    const CellVertices vertices = vertices_of(*cell);
    if (!takes(vertices)) continue;
    cell->info() = static_cast<std::uint32_t>(out.cells.size());
    out.cells.push_back(vertices);
  }
  out.neighbors.resize(out.cells.size());
  for (const auto cell : triangulation.finite_cell_handles()) {
    if (cell->info() == kNoIndex) continue;
    const CellVertices& vertices = out.cells[cell->info()];
    for (int k = 0; k < 4; ++k) {
      const auto slot = std::ranges::find(vertices, cell->vertex(k)->info()) - vertices.begin();
      out.neighbors[cell->info()][static_cast<std::size_t>(slot)] = cell->neighbor(k)->info();
    }
  }
  return out;
}

}  // namespace vdwmesh::testing
