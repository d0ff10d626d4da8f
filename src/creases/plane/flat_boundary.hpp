// The boundary of a patch after its projection to the plane: points, the straight pieces between
// them, and tests that find pieces which cross.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/monitor.hpp"
#include "creases/arcs/patch_boundary.hpp"
#include "creases/plane/stereographic.hpp"

namespace vdwmesh {

// Thrown if two points of a boundary have the same coordinates in double precision.
struct CoincidentPoints {};

// The projected boundary. All tests are exact for the rounded coordinates of the points. Points and
// pieces have the indices that they have in the PatchBoundary. Keeps references to its arguments.
class FlatBoundary {
 public:
  // `points` are the images of boundary.points.
  FlatBoundary(const PatchBoundary& boundary, std::span<const PlanePoint> points)
      : boundary_(boundary), points_(points) {}

  // All pieces that share both ends with one of these, and these.
  std::vector<std::uint32_t> doubles_of(std::span<const std::uint32_t> pieces) const;
  // The piece itself and all pieces that cross it.
  std::vector<std::uint32_t> crossings_of(std::uint32_t piece) const;
  // Every piece that crosses another one. Some are listed more than once. Throws Cancelled.
  std::vector<std::uint32_t> crossings(Monitor* monitor) const;

 private:
  // The straight segment of a piece, and the box around it.
  std::array<PlanePoint, 2> segment(std::uint32_t piece) const;
  struct PieceBox {
    PlanePoint low, high;
    std::uint32_t piece;
  };
  PieceBox box(std::uint32_t piece) const;
  bool do_cross(std::uint32_t p, std::uint32_t q) const;

  const PatchBoundary& boundary_;
  std::span<const PlanePoint> points_;
};

// For loops inside one patch; `step` counts their turns. Throws Cancelled if the caller has asked
// to stop. The monitor is asked in every 128th step, so that a patch with many points stops as soon
// as many small patches do; advance() by 0 steps reports no progress.
inline void check_cancelled(Monitor* monitor, std::size_t step) {
  constexpr std::size_t kStride = 128;
  if (step % kStride == 0) advance(monitor, 0);
}

}  // namespace vdwmesh
