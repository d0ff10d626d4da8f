// Measures one ball of a union from its caps.
//
// The exposed part of a sphere is its intersection with the power cell of the ball. CutBall makes
// this cell by cutting off one cap's half-space after another, the deepest first, and stops at the
// first plane that is farther from the centre than every vertex: so do all that follow. Cells that
// the small room cannot hold are begun again in a large one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "measures/arcs/ball_measures.hpp"
#include "measures/arcs/cap_order.hpp"

namespace vdwmesh::arcs {

// Keeps its memory from ball to ball.
class CutBall {
 public:
  // Measures the unit ball that the caps cut. The result does not depend on the order in which they
  // come. The time is n log n for n caps, and n m with the m vertices of the power cell.
  BallMeasures measure(std::span<const Cap> caps);

  // Of the last ball. A plane of the cell that is no wall is that of the cap with this index.
  const CellView& cell() const { return view_; }
  const BallMeasurer& measurer() const { return measurer_; }
  std::uint32_t cap_of(std::uint32_t plane) const { return cap_of_[plane - kWalls]; }
  // Whether several balls have the cap of one plane.
  bool has_equal_caps() const { return has_equal_caps_; }

 private:
  template <class Cell>
  bool cut(Cell& cell, std::span<const Cap> caps, std::span<const std::uint32_t> order);

  CapOrder order_;
  SmallPowerCell small_;
  PowerCell large_;
  BallMeasurer measurer_;
  CellView view_{};
  std::vector<std::uint32_t> cap_of_;
  bool has_equal_caps_ = false;
};

// Returns whether the cell had room.
template <class Cell>
VDWMESH_INLINE bool CutBall::cut(Cell& cell, std::span<const Cap> caps,
                                 std::span<const std::uint32_t> order) {
  cell.reset();
  cap_of_.clear();
  has_equal_caps_ = false;
  const Cap* last = nullptr;
  bool was_cut = true;
  for (const std::uint32_t i : order) {
    const Cap& cap = caps[i];
    // Vertices outside the ball are farther from the centre than any plane, so looking for the
    // farthest vertex pays only after the nearer half of the planes, and when planes have begun to
    // miss the cell.
    constexpr double kWorthLooking = 0.5;
    if (!was_cut && cap.cosine > kWorthLooking && cap.cosine < 1 && cell.reach() <= cap.cosine) {
      break;
    }
    // Equal balls have the same cap, of which the second would cut through rounding errors.
    const bool is_equal = last != nullptr && same_cap(*last, cap);
    has_equal_caps_ |= is_equal;
    was_cut = !is_equal && cell.cut(cap);
    if (cell.empty()) break;
    if (was_cut) cap_of_.push_back(i);
    last = &cap;
  }
  return !cell.overflowed();
}

inline BallMeasures CutBall::measure(std::span<const Cap> caps) {
  const std::span<const std::uint32_t> order = order_.sort(caps);
  if (cut(small_, caps, order)) {
    view_ = small_.finish();
  } else {
    cut(large_, caps, order);
    view_ = large_.finish();
  }
  return measurer_.measure(view_);
}

}  // namespace vdwmesh::arcs
