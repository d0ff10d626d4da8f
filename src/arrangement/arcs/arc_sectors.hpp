// Measures a ball whose power cell has hundreds of faces, sector by sector.
//
// For every new cap the kernel (arc_kernel.hpp) looks at all faces of the cell, so its time is
// quadratic. It is short for the dozens of neighbours that an atom has, but not for the thousands
// that a bead, an envelope or a nanoparticle may have. A plane through the centre of the ball
// divides the work. It changes neither the sum of the exposed areas nor, because the pyramid over
// it has height 0, the sum of the volumes. The measures of the ball are therefore sums over
// sectors. A sector is a part of the ball between three such planes, and only the few caps that
// reach it cut it. The kernel applies its checks to every sector.
#pragma once

#include <span>
#include <vector>

#include "arrangement/arcs/arc_kernel.hpp"

namespace vdwmesh::arcs {

// Host memory for the kernel's ArcWorkspace, reused from ball to ball. It only grows.
class CellSpace {
 public:
  // Returns a workspace for `caps` caps and for a cell with at most `faces` faces. It is valid
  // until the next call.
  ArcWorkspace reserve(std::size_t caps, std::size_t faces);

 private:
  std::vector<Cap> nudged_;
  std::vector<CellFace> faces_;
  std::vector<std::uint32_t> active_;  // as many as faces_
  std::vector<CellEdge> edges_;
};

// A sector is halved if more caps than this reach it.
inline constexpr std::size_t kMostCapsInSector = 64;

// Returns what measure_ball() returns, to rounding. For n caps of which few overlap at any one
// place it takes n log n time. If nearly all caps overlap each other, halving does not help and the
// time is n², as in measure_ball(). Runs in parallel; any number of threads gives the same bits.
// A sector that more than `most_caps` caps reach is halved; tests use small numbers.
BallMeasures measure_by_sectors(std::span<const Cap> caps,
                                std::size_t most_caps = kMostCapsInSector);

}  // namespace vdwmesh::arcs
