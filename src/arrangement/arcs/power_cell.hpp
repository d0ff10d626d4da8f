// The power cell of a ball as a list of vertices, cut by one plane after another (N. Ray, D.
// Sokolov, S. Lefebvre and B. Lévy 2018, "Meshless Voronoi on the GPU", ACM TOG 37, 265).
//
// A vertex names the three planes that meet in it and, for each of them, the edge that leaves the
// plane, as seen from the other end. Every vertex has exactly three planes, also in degenerate
// positions: rounding then decides which of several vertices in one place a plane cuts off, and the
// cell is that of planes moved by as little. The cell begins as a tetrahedron around the unit ball,
// whose faces the ball does not reach. power_cell_cut.hpp has the cut.
//
// Vertices stand in slots. The slot of a removed vertex stays free until the next cut, which puts a
// new vertex there; finish() closes the gaps that are left in the end. The x coordinate of a free
// slot is NaN, so that it lies beyond no plane and changes no maximum.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "arrangement/arcs/arc_cap.hpp"
#include "arrangement/arcs/doubts.hpp"
#include "core/lanes.hpp"

namespace vdwmesh::arcs {

// An edge as seen from one of its ends: 4 v + k for edge k of vertex v, which is 1, 2 or 3. Edge k
// lies in the planes of the two other edges and leaves plane k. The axes of planes 1, 2 and 3 have
// a positive determinant, so an edge runs against the cross product of the axes of the two planes
// that follow its own in the cycle 1, 2, 3. Seen from its other end the two have changed places.
using EdgeEnd = std::uint32_t;
constexpr std::uint32_t vertex_of(EdgeEnd end) { return end / 4; }
constexpr EdgeEnd end_of(std::uint32_t vertex, std::uint32_t side) { return 4 * vertex + side; }

class PowerCell {
 public:
  static constexpr std::uint32_t kWalls = 4;  // planes 0 to 3 are the tetrahedron's

  // Makes the cell the tetrahedron again. The memory is kept.
  void reset();

  // Removes the half-space beyond the plane of a cap: the points with inner(axis, x) > cosine. Caps
  // may come in any order; that of cuts_deeper() is fast. The time is linear in the number of
  // vertices. Returns whether that removed vertices.
  bool cut(const Cap& cap);

  // To be called after the last cut, and before anybody looks at vertices: afterwards vertices 0 to
  // vertex_count() - 1 are those of the cell.
  void finish();

  bool empty() const { return alive_ == 0; }
  // An upper bound of the distance from the centre to the farthest vertex. Planes at least this far
  // from the centre cut nothing off.
  double reach();
  std::uint32_t doubts() const { return doubts_; }

  std::uint32_t vertex_count() const { return slots_; }
  Vec3d vertex(std::uint32_t v) const {
    return {position_[v].at[0], position_[v].at[1], position_[v].at[2]};
  }
  // The same in three lanes; the fourth is 0.
  const double* position(std::uint32_t v) const { return position_[v].at; }
  // By the ends of edges: the plane that the edge leaves there, and its other end. For end_of(v,
  // 0), which is no end, the plane is that of end_of(v, 3), and the other end means nothing. So the
  // plane before an end is the one that precedes its own in the cycle 1, 2, 3.
  const std::uint32_t* planes_left() const { return plane_.data(); }
  const EdgeEnd* twins() const { return twin_.data(); }
  // Lane-wise access: 3 further elements behind the last vertex may be read; x is NaN there.
  const double* x() const { return x_.data(); }
  const double* y() const { return y_.data(); }
  const double* z() const { return z_.data(); }

  // The walls, then every plane that cut something off; some may have no face any more.
  std::uint32_t plane_count() const { return plane_count_; }
  const Cap& plane(std::uint32_t p) const { return planes_[p]; }

 private:
  // Vertices that a loop looks at in one step: two vectors, for fewer and more predictable ends of
  // loops.
  static constexpr std::size_t kStep = 2 * kLanes;
  static constexpr EdgeEnd kNone = 0;  // stands for no edge

  struct alignas(32) Position {
    double at[4];  // the fourth is 0
  };
  // An edge from a removed vertex, `removed` at its end, to one that stays, `kept` at its end.
  struct BorderEdge {
    EdgeEnd removed, kept;
  };
  // An edge of the new face that looks for its other end: it lies in `plane`.
  struct HalfLink {
    std::uint32_t plane;
    EdgeEnd own;
  };

  double measure_depths(const Cap& cap);
  bool find_removed(const Cap& cap);
  void doubt_near(const Cap& cap);
  std::uint32_t add_plane(const Cap& cap);
  void list_slots();
  void make_vertices(std::uint32_t plane);
  bool link_vertices();
  void free_removed();
  void move_vertex(std::uint32_t from, std::uint32_t to);
  void reserve(std::size_t vertices);

  // Slots 0 to slots_ - 1 have been used; alive_ of them have a vertex.
  std::uint32_t slots_ = 0, alive_ = 0, plane_count_ = 0, doubts_ = 0;
  double reach_ = 0;
  bool reach_is_stale_ = true;
  std::vector<double> x_, y_, z_, depth_;
  std::vector<Position> position_;    // the same as x_, y_ and z_
  std::vector<std::uint32_t> plane_;  // as planes_left()
  std::vector<EdgeEnd> twin_;
  std::vector<Cap> planes_;
  // By plane: the edge of the new face that waits for its other end; between cuts none waits.
  std::vector<EdgeEnd> open_;
  // The free slots; during a cut, those that were free before, and behind them unused ones.
  std::vector<std::uint32_t> free_;
  // During a cut. Removed vertices are in ascending order. border_ has the edges from removed
  // vertices to those that stay, and links_ what waits, by edges of border_.
  std::vector<std::uint32_t> removed_;
  std::vector<BorderEdge> border_;
  std::vector<HalfLink> links_;
  std::uint32_t free_count_ = 0, removed_count_ = 0, border_count_ = 0;
};

}  // namespace vdwmesh::arcs

#include "arrangement/arcs/power_cell_cut.hpp"
