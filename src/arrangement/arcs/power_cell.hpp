// The power cell of a ball as a list of vertices, cut by one plane after another (N. Ray, D.
// Sokolov, S. Lefebvre and B. Lévy 2018, "Meshless Voronoi on the GPU", ACM TOG 37, 265).
//
// A vertex names the three planes that meet in it and, for each of them, the vertex at the other
// end of the edge that leaves the plane. Every vertex has exactly three planes, also in degenerate
// positions: rounding then decides which of several vertices in one place a plane cuts off, and the
// cell is that of planes moved by as little. The cell begins as a tetrahedron around the unit ball,
// whose faces the ball does not reach. power_cell_cut.hpp has the cut.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "arrangement/arcs/arc_cap.hpp"
#include "arrangement/arcs/doubts.hpp"
#include "core/lanes.hpp"

namespace vdwmesh::arcs {

// The planes of a vertex and its neighbours. Edge k runs to vertex next[k] in the planes plane[k +
// 1] and plane[k + 2], indices modulo 3, and leaves plane[k]. The axes of the planes in this order
// have a positive determinant, so edge k runs against the cross product of the axes of its planes,
// in this order. The fourth elements mean nothing: make_vertices() writes there what does
// not apply, and they make all links one vector.
struct alignas(32) VertexLinks {
  std::array<std::uint32_t, 4> plane, next;
};

class PowerCell {
 public:
  static constexpr std::uint32_t kWalls = 4;  // planes 0 to 3 are the tetrahedron's

  // Makes the cell the tetrahedron again. The memory is kept.
  void reset();

  // Removes the half-space beyond the plane of a cap: the points with inner(axis, x) > cosine. Caps
  // may come in any order; that of cuts_deeper() is fast. The time is linear in the number of
  // vertices.
  void cut(const Cap& cap);

  bool empty() const { return count_ == 0; }
  // An upper bound of the distance from the centre to the farthest vertex. Planes at least this far
  // from the centre cut nothing off.
  double reach();
  std::uint32_t doubts() const { return doubts_; }

  std::uint32_t vertex_count() const { return count_; }
  Vec3d vertex(std::uint32_t v) const { return {x_[v], y_[v], z_[v]}; }
  const VertexLinks* links() const { return links_.data(); }  // by vertex
  // Lane-wise access: 3 further elements behind the last vertex may be read; they repeat vertex 0.
  const double* x() const { return x_.data(); }
  const double* y() const { return y_.data(); }
  const double* z() const { return z_.data(); }

  // The walls, then every plane that cut something off; some may have no face any more.
  std::uint32_t plane_count() const { return plane_count_; }
  const Cap& plane(std::uint32_t p) const { return planes_[p]; }

 private:
  // An edge from a removed vertex to one that stays: edge `side` of `from`.
  struct BorderEdge {
    std::uint32_t from, to, side;
  };
  // The end of an edge of the new face that waits for the other end: edge `side` of border vertex
  // `border`, which is kNone if no end waits.
  struct OpenEnd {
    std::uint32_t border, side;
  };
  // The vertex on a border edge, which is edge `back` of the end that stays.
  struct NewVertex {
    VertexLinks links;
    Vec3d position;
    std::uint32_t number, back;
  };
  static constexpr std::uint32_t kUnused = 3;  // the fourth element of VertexLinks::next
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  double measure_depths(const Cap& cap);
  bool find_removed(const Cap& cap);
  void doubt_near(const Cap& cap);
  bool make_vertices(const Cap& cap);
  void store_vertices();
  void fill_holes();
  void move_vertex(std::uint32_t from, std::uint32_t to);
  void reserve(std::size_t vertices);
  void pad();

  std::uint32_t count_ = 0, plane_count_ = 0, doubts_ = 0;
  double reach_ = 0;
  bool reach_is_stale_ = true;
  std::vector<double> x_, y_, z_, depth_;
  std::vector<VertexLinks> links_;
  std::vector<Cap> planes_;
  std::vector<OpenEnd> open_;  // by plane; between cuts no end waits
  // During a cut. Removed vertices are in ascending order.
  std::vector<std::uint32_t> removed_;
  std::vector<BorderEdge> border_;
  std::vector<NewVertex> fresh_;  // by border edge
  std::uint32_t removed_count_ = 0, border_count_ = 0;
};

}  // namespace vdwmesh::arcs

#include "arrangement/arcs/power_cell_cut.hpp"
