// Which points of a patch's boundary lie on one circle. For host and device.
#pragma once

#include <cstdint>
#include <span>

#include "arrangement/mesher/patch_boundary.hpp"
#include "arrangement/mesher/patch_memory.hpp"
#include "arrangement/mesher/row_lists.hpp"

namespace vdwmesh {

// The circles that pass through each point of a boundary. A circle of the patch's sphere is named
// by the ball on its other side. If a corner was joined, the spheres of all arcs that end in it
// count, even if they meet the patch's sphere in this point only.
template <class Memory>
class PointCirclesOf {
 public:
  PointCirclesOf() = default;
  explicit PointCirclesOf(const PatchBoundaryView& boundary) { assign(boundary); }
  // Replaces the circles by those of another boundary.
  VDWMESH_HD void assign(const PatchBoundaryView& boundary) {
    const auto each_end = [&](const auto& visit) {
      for (const BoundaryPiece& p : boundary.pieces) {
        visit(p.from, p.neighbor);
        visit(p.to, p.neighbor);
      }
      for (const SphereThrough& s : boundary.through) visit(s.point, s.ball);
    };
    circles_.fill(boundary.points.size(), each_end);
  }
  // Whether points a and b lie on one circle. Points are indices into PatchBoundary::points. Higher
  // numbers are interior points, which lie on no circle.
  VDWMESH_HD bool share(std::uint32_t a, std::uint32_t b) const {
    for (const std::uint32_t neighbor : of(a)) {
      if (on(b, neighbor)) return true;
    }
    return false;
  }
  // Whether four points lie on one circle.
  VDWMESH_HD bool share(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
    for (const std::uint32_t neighbor : of(a)) {
      if (on(b, neighbor) && on(c, neighbor) && on(d, neighbor)) return true;
    }
    return false;
  }
  // Whether the circle shared with `neighbor` passes through the point.
  VDWMESH_HD bool on(std::uint32_t point, std::uint32_t neighbor) const {
    for (const std::uint32_t circle : of(point)) {
      if (circle == neighbor) return true;
    }
    return false;
  }
  // Calls visit(array, kind) for every array, to give bounded ones their memory.
  template <class Visit>
  VDWMESH_HD void visit_arrays(const Visit& visit) {
    circles_.visit_arrays([&](auto& rows) { visit(rows, PatchArray::circle_rows); },
                          [&](auto& entries) { visit(entries, PatchArray::circle_entries); });
  }

 private:
  // The circles of one point, possibly with repetitions. Numbers past all points of the boundary
  // are interior points, which have none.
  VDWMESH_HD std::span<const std::uint32_t> of(std::uint32_t point) const {
    if (point >= circles_.size()) return {};
    return circles_[point];
  }

  RowListsOf<Memory> circles_;
};

using PointCircles = PointCirclesOf<GrowingMemory>;

}  // namespace vdwmesh
