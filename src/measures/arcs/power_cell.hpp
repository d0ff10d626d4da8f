// The power cell of a ball as a list of vertices, cut by one plane after another (N. Ray, D.
// Sokolov, S. Lefebvre and B. Lévy 2018, "Meshless Voronoi on the GPU", ACM TOG 37, 265).
//
// A vertex names the three planes that meet in it and, for each of them, the edge that leaves the
// plane, as seen from its other end (EdgeEnd). Every vertex has exactly three planes. If more
// planes meet in one point, several vertices lie there, and rounding decides which of them a plane
// cuts off: the cell is then that of planes moved by no more than rounding errors. The cell begins
// as a tetrahedron around the unit ball, whose faces (walls) the ball does not reach.
// power_cell_cut.hpp has the cut.
//
// Vertices are stored in slots. The slot of a removed vertex is free until a later cut puts a new
// vertex there; finish() closes the gaps that are left. The x coordinate of a free slot is NaN, so
// that the slot counts as beyond no plane and changes no maximum. The arrays are in cell_room.hpp.
#pragma once

#include <cstdint>

#include "core/lanes/lanes.hpp"
#include "measures/arcs/arc_cap.hpp"
#include "measures/arcs/cell_room.hpp"
#include "measures/arcs/doubts.hpp"

namespace vdwmesh::arcs {

// What a measurer reads of a cell.
struct CellView {
  std::uint32_t vertex_count;
  // The walls, then every plane that cut something off. Later cuts may have removed all of its
  // face.
  std::uint32_t plane_count;
  std::uint32_t doubts;
  // Lane-wise access: 3 further elements behind the last vertex may be read; x is NaN there.
  const double *x, *y, *z;
  const Position* position;  // the same coordinates, vertex by vertex
  // By EdgeEnd: the plane that the edge leaves there, and the edge's other end. Elements end_of(v,
  // 0) belong to no edge. plane_left has the plane of end_of(v, 3) there: so plane_left[end - 1] is
  // for every end the plane that precedes its own in the cycle 1, 2, 3.
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
  // Replaces the cell by the tetrahedron. The memory is kept.
  void reset();

  // Removes the half-space beyond the plane of a cap: the points with inner(axis, x) > cosine.
  // Returns whether this removed vertices. Caps may come in any order; the order of cuts_deeper()
  // is fast. The time is linear in the number of vertices.
  bool cut(const Cap& cap);

  // Whether the arrays were too small for a cut. The cell is then not valid.
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

// A cell of any size.
using PowerCell = PowerCellIn<GrowingRoom>;
// A cell of at most 64 vertices, so that one 64-bit number has a bit for each of them.
using SmallPowerCell = PowerCellIn<FixedRoom<64, 64>>;

}  // namespace vdwmesh::arcs

#include "measures/arcs/power_cell_cut.hpp"
