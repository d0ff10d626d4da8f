// A ball whose power cell has hundreds of faces, sector by sector.
//
// The kernel looks at every face of the cell for every new cap, which is quick for the dozens of
// neighbours that atoms have and quadratic for the thousands of a bead, an envelope or a
// nanoparticle. A plane through the centre of the ball splits the work: it adds nothing to the area
// and, because its pyramid has no height, nothing to the volume. So the measures of the ball are
// the sums over sectors, each bounded by three such planes and cut by the few caps that reach it,
// and every sector passes the checks of the kernel by itself.
#pragma once

#include <span>
#include <vector>

#include "arrangement/arcs/arc_kernel.hpp"

namespace vdwmesh::arcs {

// Memory for the kernel, kept from ball to ball.
class CellSpace {
 public:
  // Room for `caps` caps and for the faces and edges of a cell with at most `faces` faces.
  ArcWorkspace reserve(std::size_t caps, std::size_t faces);

 private:
  std::vector<Cap> nudged_;
  std::vector<CellFace> faces_;
  std::vector<std::uint32_t> active_;
  std::vector<CellEdge> edges_;
};

// Sectors are halved until no more caps than this reach one of them.
inline constexpr std::size_t kMostCapsInSector = 64;

// The measures of measure_ball(), to rounding, in time n log n for n caps of which few overlap in
// any one place. Caps that overlap nearly all others cost n² as there: such sectors are not halved.
// Runs in parallel; the same bits for any number of threads. `most_caps` is for tests.
BallMeasures measure_by_sectors(std::span<const Cap> caps,
                                std::size_t most_caps = kMostCapsInSector);

}  // namespace vdwmesh::arcs
