// Measures a ball whose power cell has hundreds of faces, sector by sector.
//
// For every new cap the kernel looks at all faces of the cell. This is fast for the dozens of
// neighbours that an atom has, and quadratic for the thousands that a bead, an envelope or a
// nanoparticle may have. A plane through the centre of the ball divides the work: it adds nothing
// to the exposed area, and its pyramid has height 0 and adds nothing to the volume. The measures of
// the ball are therefore sums over sectors. A sector is bounded by three such planes and cut by the
// few caps that reach it. The kernel applies its checks to every sector.
#pragma once

#include <span>
#include <vector>

#include "arrangement/arcs/arc_kernel.hpp"

namespace vdwmesh::arcs {

// Memory for the kernel, reused from ball to ball. It only grows.
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
// `most_caps` is for tests.
BallMeasures measure_by_sectors(std::span<const Cap> caps,
                                std::size_t most_caps = kMostCapsInSector);

}  // namespace vdwmesh::arcs
