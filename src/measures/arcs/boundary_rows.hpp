// The exposed corners and arcs of a union's boundary, ball by ball, from the power cell of each
// ball. A ball has the corners and arcs in whose lists of balls it is the first; it also lists its
// neighbours. What double precision does not decide is left to the caller.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/monitor.hpp"
#include "measures/exposed_boundary.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// A CornerArc with its corners themselves; they do not matter for a whole circle.
struct NamedArc {
  std::array<std::uint32_t, 2> balls;  // ascending
  bool is_circle;
  ExposedCorner start, end;
};

// What some balls have, one ball behind the other, in no particular order within a ball.
class BoundaryRows {
 public:
  std::vector<ExposedCorner> corners;
  std::vector<NamedArc> arcs;
  std::vector<std::uint32_t> neighbors;

  // Ends the row of a ball.
  void end_row() { ends_.push_back({corners.size(), arcs.size(), neighbors.size()}); }
  // Removes what was added since the last row's end.
  void drop_row();

  std::size_t size() const { return ends_.size() - 1; }
  std::span<const ExposedCorner> corners_of(std::size_t row) const {
    return std::span(corners).subspan(ends_[row][0], ends_[row + 1][0] - ends_[row][0]);
  }
  std::span<const NamedArc> arcs_of(std::size_t row) const {
    return std::span(arcs).subspan(ends_[row][1], ends_[row + 1][1] - ends_[row][1]);
  }
  std::span<const std::uint32_t> neighbors_of(std::size_t row) const {
    return std::span(neighbors).subspan(ends_[row][2], ends_[row + 1][2] - ends_[row][2]);
  }

 private:
  std::vector<std::array<std::size_t, 3>> ends_{{0, 0, 0}};
};

inline constexpr std::size_t kBallsPerRows = 64;

// Of all balls.
struct CellBoundary {
  std::vector<BoundaryRows> rows;         // of kBallsPerRows balls each
  std::vector<std::uint8_t> is_doubtful;  // by ball: not decided; its row is empty
  std::vector<double> areas;              // exposed, by ball
};

// `list`: of the balls, each with its number as id. The result does not depend on the number of
// threads. Throws Cancelled; the monitor is asked once in some hundred balls.
CellBoundary cell_boundary(const CellListView& list, Monitor* monitor = nullptr);

}  // namespace vdwmesh
