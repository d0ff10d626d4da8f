// The boundary of a patch after its projection to the plane: points, the straight pieces between
// them, and tests that find pieces which cannot be constraints of one triangulation.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "arrangement/mesher/patch_boundary.hpp"
#include "arrangement/mesher/stereographic.hpp"
#include "core/monitor.hpp"

namespace vdwmesh {

// Thrown if two points of a boundary have the same coordinates in double precision.
struct CoincidentPoints {};

// The projected boundary. All tests are exact for the rounded coordinates of the points. Points and
// pieces have the indices that they have in the PatchBoundary, to which the object keeps a
// reference.
class FlatBoundary {
 public:
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Point = Kernel::Point_2;

  // Projects the points. Throws CoincidentPoints if two of them coincide in the plane.
  FlatBoundary(const PatchBoundary& boundary, const Stereographic& plane);

  const Point& point(std::uint32_t i) const { return points_[i]; }
  // The piece that joins points a and b, in either direction. Precondition: there is such a piece.
  std::uint32_t piece_between(std::uint32_t a, std::uint32_t b) const;
  // The pieces that cannot have an edge of the triangulation each: pieces from a point to itself,
  // and all pieces that share both ends with another piece. Some are listed more than once.
  std::vector<std::uint32_t> doubled_pieces() const;
  // The piece itself and all pieces that cross it.
  std::vector<std::uint32_t> crossings_of(std::uint32_t piece) const;
  // Every piece that crosses another one. Some are listed more than once. Throws Cancelled.
  std::vector<std::uint32_t> crossings(Monitor* monitor) const;

 private:
  // The straight segment of a piece.
  Kernel::Segment_2 segment(std::uint32_t piece) const;
  bool do_cross(std::uint32_t p, std::uint32_t q) const;

  const PatchBoundary& boundary_;
  std::vector<Point> points_;
  // Entries (lower end, higher end, piece), sorted, for binary search.
  std::vector<std::array<std::uint32_t, 3>> by_ends_;
};

// For loops inside one patch; `step` counts their turns. Throws Cancelled if the caller has asked
// to stop. The monitor is asked in every 128th step, so that a patch with many points stops as soon
// as many small patches do; advance() by 0 steps reports no progress.
inline void check_cancelled(Monitor* monitor, std::size_t step) {
  constexpr std::size_t kStride = 128;
  if (step % kStride == 0) advance(monitor, 0);
}

}  // namespace vdwmesh
