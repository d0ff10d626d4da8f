// The boundary of a patch in the plane: points and the straight pieces between them, and which of
// those cannot stand together.
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

// Thrown where two points of a boundary are one in double precision.
struct CoincidentPoints {};

// Keeps a reference to the boundary.
class FlatBoundary {
 public:
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Point = Kernel::Point_2;

  // Throws CoincidentPoints.
  FlatBoundary(const PatchBoundary& boundary, const Stereographic& plane);

  const Point& point(std::uint32_t i) const { return points_[i]; }
  // The piece between two points that one joins.
  std::uint32_t piece_between(std::uint32_t a, std::uint32_t b) const;
  // Pieces from a point to itself, and those with the same two ends.
  std::vector<std::uint32_t> doubled_pieces() const;
  // The piece itself and those that cross it (exact).
  std::vector<std::uint32_t> crossings_of(std::uint32_t piece) const;
  // Every piece that crosses another, some more than once. Throws Cancelled.
  std::vector<std::uint32_t> crossings(Monitor* monitor) const;

 private:
  Kernel::Segment_2 segment(std::uint32_t piece) const;
  bool do_cross(std::uint32_t p, std::uint32_t q) const;

  const PatchBoundary& boundary_;
  std::vector<Point> points_;
  std::vector<std::array<std::uint32_t, 3>> by_ends_;  // low end, high end, piece; sorted
};

// Asks every so many steps, so that a patch of many points stops as soon as many small ones.
inline void check_cancelled(Monitor* monitor, std::size_t step) {
  constexpr std::size_t kStride = 128;
  if (step % kStride == 0) advance(monitor, 0);
}

}  // namespace vdwmesh
