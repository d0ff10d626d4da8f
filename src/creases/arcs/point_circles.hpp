// Which points of a patch's boundary lie on one circle. For host and device.
#pragma once

#include <cstdint>
#include <span>

#include "creases/arcs/patch_boundary.hpp"
#include "creases/patch/patch_memory.hpp"
#include "creases/plane/row_lists.hpp"

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
    has_pairs_ = boundary.through.empty() && assign_pairs(boundary);
    if (has_pairs_) return;
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
    visit(pairs_, PatchArray::circle_entries);
  }

 private:
  // One piece begins at nearly every point and one ends there: then pairs_ is all there is to know.
  // It is so if there are as many points as pieces, and both of each point's places are taken.
  VDWMESH_HD bool assign_pairs(const PatchBoundaryView& boundary) {
    if (boundary.points.size() != boundary.pieces.size()) return false;
    pairs_.assign(2 * boundary.points.size(), std::uint32_t{kNoIndex});
    for (const BoundaryPiece& p : boundary.pieces) {
      pairs_[2 * p.from] = p.neighbor;
      pairs_[2 * p.to + 1] = p.neighbor;
    }
    for (const std::uint32_t neighbor : pairs_) {
      if (neighbor == kNoIndex) return false;
    }
    return true;
  }

  // The circles of one point, possibly with repetitions. Numbers past all points of the boundary
  // are interior points, which have none.
  VDWMESH_HD std::span<const std::uint32_t> of(std::uint32_t point) const {
    if (has_pairs_) {
      if (2 * std::size_t{point} >= pairs_.size()) return {};
      return {pairs_.data() + 2 * std::size_t{point}, 2};
    }
    if (point >= circles_.size()) return {};
    return circles_[point];
  }

  bool has_pairs_ = false;
  // By point: the circles of the piece that begins there and of the one that ends there.
  typename Memory::template Array<std::uint32_t> pairs_;
  RowListsOf<Memory> circles_;  // without pairs
};

using PointCircles = PointCirclesOf<GrowingMemory>;

}  // namespace vdwmesh
