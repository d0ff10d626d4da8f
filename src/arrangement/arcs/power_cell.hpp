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
// slot is NaN, so that it lies beyond no plane and changes no maximum. The arrays are in
// cell_room.hpp.
#pragma once

#include <cstdint>

#include "arrangement/arcs/arc_cap.hpp"
#include "arrangement/arcs/cell_room.hpp"
#include "arrangement/arcs/doubts.hpp"
#include "core/lanes.hpp"

namespace vdwmesh::arcs {

// What a measurer reads of a cell.
struct CellView {
  std::uint32_t vertex_count;
  // The walls, then every plane that cut something off; some may have no face any more.
  std::uint32_t plane_count;
  std::uint32_t doubts;
  // Lane-wise access: 3 further elements behind the last vertex may be read; x is NaN there.
  const double *x, *y, *z;
  const Position* position;  // the same
  // By the ends of edges: the plane that the edge leaves there, and its other end. For end_of(v,
  // 0), which is no end, the plane is that of end_of(v, 3), and the other end means nothing. So the
  // plane before an end is the one that precedes its own in the cycle 1, 2, 3.
  const std::uint32_t* plane_left;
  const EdgeEnd* twin;
  const Cap* plane;

  bool empty() const { return vertex_count == 0; }
  Vec3d vertex(std::uint32_t v) const {
    return {position[v].at[0], position[v].at[1], position[v].at[2]};
  }
};

inline constexpr std::uint32_t kWalls = 4;  // planes 0 to 3 are the tetrahedron's

template <class Room>
class PowerCellIn {
 public:
  // Makes the cell the tetrahedron again. The memory is kept.
  void reset();

  // Removes the half-space beyond the plane of a cap: the points with inner(axis, x) > cosine. Caps
  // may come in any order; that of cuts_deeper() is fast. The time is linear in the number of
  // vertices. Returns whether that removed vertices.
  bool cut(const Cap& cap);

  // Whether the room was too small for a cut. The cell then means nothing.
  bool overflowed() const { return overflowed_; }
  bool empty() const { return alive_ == 0; }
  // An upper bound of the distance from the centre to the farthest vertex. Planes at least this far
  // from the centre cut nothing off.
  double reach();

  // Closes the gaps between the vertices, so that they have the numbers from 0 to the view's
  // vertex_count - 1. To be called after the last cut.
  CellView finish();

 private:
  static constexpr EdgeEnd kNone = 0;  // stands for no edge

  double measure_depths(const Cap& cap);
  bool find_removed(const Cap& cap);
  void doubt_near(const Cap& cap);
  void list_slots();
  void make_vertices(std::uint32_t plane);
  bool link_vertices();
  void free_removed();
  void move_vertex(std::uint32_t from, std::uint32_t to);

  // Slots 0 to slots_ - 1 have been used; alive_ of them have a vertex.
  std::uint32_t slots_ = 0, alive_ = 0, plane_count_ = 0, doubts_ = 0;
  double reach_ = 0;
  bool reach_is_stale_ = true, overflowed_ = false;
  std::uint32_t free_count_ = 0, removed_count_ = 0, border_count_ = 0;
  Room room_;
};

// Of any size.
using PowerCell = PowerCellIn<GrowingRoom>;
// For what is removed, 64 vertices have a bit each of one number.
using SmallPowerCell = PowerCellIn<FixedRoom<64, 64>>;

}  // namespace vdwmesh::arcs

#include "arrangement/arcs/power_cell_cut.hpp"
