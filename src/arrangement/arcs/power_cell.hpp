// The power cell of a ball as a list of vertices, cut by one plane after another (N. Ray, D.
// Sokolov, S. Lefebvre and B. Lévy 2018, "Meshless Voronoi on the GPU", ACM TOG 37, 265).
//
// A vertex names the three planes that meet in it and, for each of them, the edge that leaves the
// plane, as seen from the other end. Every vertex has exactly three planes, also in degenerate
// positions: rounding then decides which of several vertices in one place a plane cuts off, and the
// cell is that of planes moved by as little. The cell begins as a tetrahedron around the unit ball,
// whose faces the ball does not reach. power_cell_cut.hpp has the cut.
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

// An edge as seen from one of its ends: 4 v + k for edge k of vertex v, which is 1, 2 or 3. Element
// 0 of what a vertex has by edge means nothing: what does not apply is written there.
using EdgeEnd = std::uint32_t;
constexpr std::uint32_t vertex_of(EdgeEnd end) { return end / 4; }
constexpr std::uint32_t side_of(EdgeEnd end) { return end % 4; }
constexpr EdgeEnd end_of(std::uint32_t vertex, std::uint32_t side) { return 4 * vertex + side; }

// By the edges of a vertex. Edge k lies in the planes of the two other edges and leaves plane k.
// The axes of planes 1, 2 and 3 have a positive determinant, so an edge runs against the cross
// product of the axes of the two planes that follow its own in the cycle 1, 2, 3.
struct alignas(16) ByEdge {
  std::array<std::uint32_t, 4> at;
};
using FourNumbers = std::uint32_t __attribute__((vector_size(16)));
VDWMESH_INLINE FourNumbers numbers_of(const ByEdge& of) {
  FourNumbers numbers;
  std::memcpy(&numbers, &of, sizeof numbers);
  return numbers;
}
VDWMESH_INLINE void store_numbers(ByEdge& to, const FourNumbers& numbers) {
  std::memcpy(&to, &numbers, sizeof numbers);
}
inline constexpr std::array<std::uint32_t, 4> kNextSide{0, 2, 3, 1}, kAfterNextSide{0, 3, 1, 2};

class PowerCell {
 public:
  static constexpr std::uint32_t kWalls = 4;  // planes 0 to 3 are the tetrahedron's

  // Makes the cell the tetrahedron again. The memory is kept.
  void reset();

  // Removes the half-space beyond the plane of a cap: the points with inner(axis, x) > cosine. Caps
  // may come in any order; that of cuts_deeper() is fast. The time is linear in the number of
  // vertices. Returns whether that removed vertices.
  bool cut(const Cap& cap);

  bool empty() const { return count_ == 0; }
  // An upper bound of the distance from the centre to the farthest vertex. Planes at least this far
  // from the centre cut nothing off.
  double reach();
  std::uint32_t doubts() const { return doubts_; }

  std::uint32_t vertex_count() const { return count_; }
  Vec3d vertex(std::uint32_t v) const { return {x_[v], y_[v], z_[v]}; }
  const ByEdge* planes_of() const { return plane_.data(); }  // by vertex
  const ByEdge* twins_of() const { return twin_.data(); }  // by vertex: the other ends of its edges
  // Lane-wise access: 3 further elements behind the last vertex may be read; they repeat vertex 0.
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
  static constexpr EdgeEnd kNone = 0;  // element 0 of vertex 0: stands for no edge

  struct alignas(32) Position {
    double at[4];  // the fourth means nothing
  };
  // An edge from a removed vertex, `removed` at its end, to one that stays, `kept` at its end.
  struct BorderEdge {
    EdgeEnd removed, kept;
  };
  struct NewVertex {
    Position position;
    ByEdge plane;
  };

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
  std::vector<Position> position_;  // the same as x_, y_ and z_
  std::vector<ByEdge> plane_, twin_;
  std::vector<Cap> planes_;
  // By plane: the edge of the new face that waits for its other end; between cuts none waits.
  std::vector<EdgeEnd> open_;
  // During a cut. Removed vertices are in ascending order; behind them stand the numbers that more
  // new vertices get. border_ has the edges from removed vertices to those that stay.
  std::vector<std::uint32_t> removed_;
  std::vector<BorderEdge> border_;
  std::vector<NewVertex> new_;  // by border edge
  std::uint32_t removed_count_ = 0, border_count_ = 0;
};

}  // namespace vdwmesh::arcs

#include "arrangement/arcs/power_cell_cut.hpp"
