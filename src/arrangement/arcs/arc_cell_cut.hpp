// BallCell::cut(): removes a half-space from the body. Included by arc_cell.hpp alone.
//
// 1. clip_edges() shortens or removes the edges that reach beyond the new plane.
// 2. add_face() (arc_cell_chords.hpp) adds the edges that the new plane has in common with the
//    faces of the body.
// 3. drop_faces() forgets the faces of which nothing is left, and keeps the new one if it has an
//    edge or is a whole disk.
// The "depth" of a point is its signed distance beyond the new plane: positive for points that the
// cut removes. Two counters say at any time whether some of the sphere is exposed: exposed_ends_
// counts the edge ends on the sphere, whole_disks_ the faces of the body that are not crossed.
#pragma once

#include "arrangement/arcs/arc_cell.hpp"

namespace vdwmesh::arcs {

// Number of bits in a mask of EdgeEnd.
inline int end_count(std::uint8_t ends) { return (ends & 1) + (ends >> 1); }

inline void BallCell::cut(const Cap& cap) {
  if (empty_ || overflowed()) return;
  // Caps have cosines in (-1, 1), and a nudge moves them by 2e-11 at most, so a cap that fails this
  // test is NaN. A NaN in the axis always comes with a NaN in the cosine.
  if (!(std::abs(cap.cosine) < 2)) {
    doubts_ |= kNotFinite;
    return;
  }
  if (face_slots_ == space_.face_capacity) {
    doubts_ |= kOverflow;
    return;
  }
  const bool was_closed = closed();
  const std::uint32_t fresh = face_slots_;
  // A polytope has no room for a whole disk, so its new face counts as crossed from the start. The
  // sums that measure_cell() fills start empty: a product of 1 and sums of 0.
  space_.faces[fresh] = {
      cap, (1 - cap.cosine) * (1 + cap.cosine), 0, was_closed, false, {1, 0}, 0, 0, 0};
  const bool touched = clip_edges(fresh);
  // If no edge of a polytope reaches beyond the plane, nothing of it does. A body with exposed
  // parts may reach farther than its edges.
  if (was_closed && !touched) return;
  if (!add_face(fresh, was_closed)) return;
  drop_faces(fresh);
  reach_is_stale_ = true;
}

// Returns the parameter s at which the edge meets the plane of the face in slot `plane`. `direct`
// is s as the caller computed it, from the edge and the plane alone. With EdgeEnding::shared the
// planes of axes a, b, c and distances t are ordered by slot, so that all three edges that end in
// their common point x compute it with the same bits:
//   x = (t_a b×c + t_b c×a + t_c a×b) / det(a, b, c).
inline double BallCell::end_at(const CellEdge& edge, std::uint32_t plane, double direct) const {
  if (ending_ == EdgeEnding::direct) return direct;
  std::uint32_t i = edge.a, j = edge.b, k = plane;  // edge.a < edge.b
  if (k < i) {
    k = j;
    j = i;
    i = plane;
  } else if (k < j) {
    k = j;
    j = plane;
  }
  const Cap& a = space_.faces[i].cap;
  const Cap& b = space_.faces[j].cap;
  const Cap& c = space_.faces[k].cap;
  const Vec3d bc = cross(b.axis, c.axis);
  const Vec3d sum =
      a.cosine * bc + b.cosine * cross(c.axis, a.axis) + c.cosine * cross(a.axis, b.axis);
  const Vec3d point = (1 / inner(a.axis, bc)) * sum;
  const double at = inner(point - edge.middle, edge.half) / inner(edge.half, edge.half);
  // `at` is not finite if planes are parallel to the last bit, and outside [-1, 1] it is no point
  // of the chord. The comparison is false in both cases.
  return std::abs(at) <= 1 ? at : direct;
}

// Shortens or removes the edges that reach beyond the plane of slot `fresh`, and marks their faces
// as touched. Returns whether there was such an edge.
inline bool BallCell::clip_edges(std::uint32_t fresh) {
  const Cap& cap = space_.faces[fresh].cap;
  bool touched = false, along = false;
  double depth = 1;  // the least depth of an edge end, or 1 if that is greater
  for (std::uint32_t i = 0; i < edge_count_;) {
    CellEdge& e = space_.edges[i];
    // The depth of the point x(s) of the edge is slope * s - room.
    const double room = cap.cosine - inner(cap.axis, e.middle);
    const double slope = inner(cap.axis, e.half);
    const double upper_depth = slope * e.upper - room;
    const double lower_depth = slope * e.lower - room;
    const double least = upper_depth < lower_depth ? upper_depth : lower_depth;
    depth = least < depth ? least : depth;
    const bool upper_out = upper_depth > kSlack;
    const bool lower_out = lower_depth > kSlack;
    if (!upper_out && !lower_out) {
      along = along || (upper_depth > -kTouching && lower_depth > -kTouching);
      ++i;
      continue;
    }
    touched = true;
    along = along || (std::abs(upper_depth) < kTouching && std::abs(lower_depth) < kTouching);
    space_.faces[e.a].touched = space_.faces[e.b].touched = true;
    const std::uint8_t before = e.exposed;
    if (upper_out) {
      e.upper = end_at(e, fresh, room / slope);
      e.exposed &= static_cast<std::uint8_t>(~kUpperEnd);
    }
    if (lower_out) {
      e.lower = end_at(e, fresh, room / slope);
      e.exposed &= static_cast<std::uint8_t>(~kLowerEnd);
    }
    exposed_ends_ -= static_cast<std::uint32_t>(end_count(before) - end_count(e.exposed));
    if ((upper_out && lower_out) || !(e.lower < e.upper)) {
      remove_edge(i);  // another edge is at i then
    } else {
      ++i;
    }
  }
  // `along`: both ends of an edge are on the plane, to kTouching. Then rounding decides which faces
  // lose the edge, and a face that still has a part before the plane may be dropped.
  if (touched && along) doubts_ |= kParallelPlanes;
  // If even the least deep edge end is on the plane to kTouching, the body is nearly or quite gone.
  if (touched && std::abs(depth) < kTouching) {
    doubts_ |= std::abs(depth) < kCertain ? kVanished : kVanishing;
  }
  return touched;
}

// Moves the last edge of the list to position i, in place of the removed one. A caller that goes
// through the list must look at position i again.
inline void BallCell::remove_edge(std::uint32_t i) {
  const CellEdge& e = space_.edges[i];
  --space_.faces[e.a].edge_count;
  --space_.faces[e.b].edge_count;
  exposed_ends_ -= static_cast<std::uint32_t>(end_count(e.exposed));
  space_.edges[i] = space_.edges[--edge_count_];
}

inline void BallCell::push_edge(const CellEdge& edge) {
  if (edge_count_ == space_.edge_capacity) {
    doubts_ |= kOverflow;
    return;
  }
  space_.edges[edge_count_++] = edge;
  ++space_.faces[edge.a].edge_count;
  ++space_.faces[edge.b].edge_count;
  exposed_ends_ += static_cast<std::uint32_t>(end_count(edge.exposed));
}

// Drops the faces of which nothing is left: those that are crossed and have no edge. They cannot
// come back, because the body only shrinks. Their slots are not used again. The new face gets its
// slot for good only if it stays.
inline void BallCell::drop_faces(std::uint32_t fresh) {
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < active_count_; ++i) {
    CellFace& face = space_.faces[space_.active[i]];
    face.touched = false;
    if (!face.crossed || face.edge_count > 0) space_.active[kept++] = space_.active[i];
  }
  active_count_ = kept;
  const CellFace& face = space_.faces[fresh];
  if (!face.crossed || face.edge_count > 0) {
    if (!face.crossed) ++whole_disks_;
    space_.active[active_count_++] = fresh;
    ++face_slots_;
  }
  empty_ = active_count_ == 0;
}

inline bool BallCell::out_of_reach(double cosine) {
  // Planes much nearer than the farthest corner will cut and make the bound stale at once. It is
  // computed only when the next plane is at least this fraction of the old bound away.
  constexpr double kWorthLooking = 0.6;
  if (!closed() || cosine < kWorthLooking * reach_) return false;
  if (reach_is_stale_) update_reach();
  return cosine >= reach_;
}

// Sets reach_ to the distance from the centre to the farthest edge end, a bound for the whole
// polytope. `middle` and `half` are orthogonal, so |x(s)|² = |middle|² + s² |half|². kSlack covers
// the rounding.
inline void BallCell::update_reach() {
  double squared = 0;
  for (std::uint32_t i = 0; i < edge_count_; ++i) {
    const CellEdge& e = space_.edges[i];
    const double s = -e.lower > e.upper ? -e.lower : e.upper;
    const double here = inner(e.middle, e.middle) + s * s * inner(e.half, e.half);
    squared = here > squared ? here : squared;
  }
  reach_ = std::sqrt(squared) + kSlack;
  reach_is_stale_ = false;
}

}  // namespace vdwmesh::arcs
