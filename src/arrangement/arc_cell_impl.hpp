// The cutting itself; included by arc_cell.hpp alone.
#pragma once

#include "arrangement/arc_cell.hpp"

namespace vdwmesh::arcs {

VDWMESH_HD inline int end_count(std::uint8_t ends) { return (ends & 1) + (ends >> 1); }

VDWMESH_HD inline void BallCell::cut(const Cap& cap) {
  if (empty_ || overflowed()) return;
  if (face_slots_ == space_.face_capacity) {
    doubts_ |= kOverflow;
    return;
  }
  const bool was_closed = closed();
  const std::uint32_t fresh = face_slots_;
  space_.faces[fresh] = {
      cap, (1 - cap.cosine) * (1 + cap.cosine), 0, was_closed, false, {1, 0}, 0, 0, 0};
  const bool touched = clip_edges(fresh);
  if (was_closed && !touched) return;
  if (!add_face(fresh, was_closed)) return;
  drop_faces(fresh);
  update_reach();
}

// Parameter of the edge's end at the plane; `direct` is what the edge alone says.
VDWMESH_HD inline double BallCell::end_at(const CellEdge& edge, std::uint32_t plane,
                                          double direct) const {
  if (ending_ == EdgeEnding::direct) return direct;
  std::uint32_t i = edge.a, j = edge.b, k = plane;  // a < b always
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
  // Not finite where the planes are parallel to the last bit.
  return std::abs(at) <= 1 ? at : direct;
}

// Shortens or removes the edges that reach beyond the plane; whether there were any.
VDWMESH_HD inline bool BallCell::clip_edges(std::uint32_t fresh) {
  const Cap& cap = space_.faces[fresh].cap;
  bool touched = false;
  depth_ = 1;
  for (std::uint32_t i = 0; i < edge_count_;) {
    CellEdge& e = space_.edges[i];
    const double room = cap.cosine - inner(cap.axis, e.middle);
    const double slope = inner(cap.axis, e.half);
    const double upper_depth = slope * e.upper - room;
    const double lower_depth = slope * e.lower - room;
    const double least = upper_depth < lower_depth ? upper_depth : lower_depth;
    depth_ = least < depth_ ? least : depth_;
    const bool upper_out = upper_depth > kSlack;
    const bool lower_out = lower_depth > kSlack;
    if (!upper_out && !lower_out) {
      ++i;
      continue;
    }
    touched = true;
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
      remove_edge(i);
    } else {
      ++i;
    }
  }
  return touched;
}

VDWMESH_HD inline void BallCell::remove_edge(std::uint32_t i) {
  const CellEdge& e = space_.edges[i];
  --space_.faces[e.a].edge_count;
  --space_.faces[e.b].edge_count;
  exposed_ends_ -= static_cast<std::uint32_t>(end_count(e.exposed));
  space_.edges[i] = space_.edges[--edge_count_];
}

VDWMESH_HD inline void BallCell::push_edge(const CellEdge& edge) {
  if (edge_count_ == space_.edge_capacity) {
    doubts_ |= kOverflow;
    return;
  }
  space_.edges[edge_count_++] = edge;
  ++space_.faces[edge.a].edge_count;
  ++space_.faces[edge.b].edge_count;
  exposed_ends_ += static_cast<std::uint32_t>(end_count(edge.exposed));
}

// Caps come sorted and without repeated planes, so of two that look the same way the new one is
// hidden.
VDWMESH_HD inline BallCell::Relation BallCell::relate_parallel(const CellFace& old,
                                                               const CellFace& fresh,
                                                               double cosine) {
  if (cosine > 0) return Relation::new_hidden;
  const double gap = fresh.cap.cosine + old.cap.cosine;
  if (std::abs(gap) < kParallelGap) doubts_ |= kParallelPlanes;
  return gap > 0 ? Relation::apart : Relation::nothing_left;
}

// How the two circles lie; where they cross, the chord of their planes.
VDWMESH_HD inline BallCell::Relation BallCell::relate(const CellFace& old, const CellFace& fresh,
                                                      CellEdge& edge) {
  const Cap& a = old.cap;
  const Cap& b = fresh.cap;
  const Vec3d normal = {a.axis.y * b.axis.z - a.axis.z * b.axis.y,
                        a.axis.z * b.axis.x - a.axis.x * b.axis.z,
                        a.axis.x * b.axis.y - a.axis.y * b.axis.x};
  const double squared_sine = inner(normal, normal);
  const double cosine = inner(a.axis, b.axis);
  if (squared_sine < kParallel) return relate_parallel(old, fresh, cosine);
  const double toward_b = b.cosine - cosine * a.cosine;  // < 0: circle a lies beyond plane b
  const double toward_a = a.cosine - cosine * b.cosine;
  const double gram = old.squared_sine * squared_sine - toward_b * toward_b;
  if (!(gram > 0)) {
    if (toward_a <= 0 && toward_b <= 0) return Relation::nothing_left;
    if (toward_a <= 0) return Relation::new_hidden;
    return toward_b <= 0 ? Relation::old_hidden : Relation::apart;
  }
  const double root = std::sqrt(gram);
  const double inverse = 1 / squared_sine;
  edge.middle = a.cosine * a.axis + (toward_b * inverse) * (b.axis - cosine * a.axis);
  edge.scale = root * inverse;
  edge.half = edge.scale * normal;
  edge.lower = -1;
  edge.upper = 1;
  edge.cosine = cosine;
  edge.root = root;
  edge.toward_b = toward_b;
  edge.toward_a = toward_a;
  edge.exposed = kLowerEnd | kUpperEnd;
  return Relation::crossing;
}

// Adds the new plane's edges. False when the plane turns out to cut nothing, or leaves nothing.
VDWMESH_HD inline bool BallCell::add_face(std::uint32_t fresh, bool was_closed) {
  CellFace& face = space_.faces[fresh];
  CellEdge edge;
  for (std::uint32_t i = 0; i < active_count_; ++i) {
    CellFace& old = space_.faces[space_.active[i]];
    // In a polytope the new plane's edges lie on faces that lose a corner.
    if (was_closed && !old.touched) continue;
    const Relation relation = relate(old, face, edge);
    if (relation == Relation::apart) continue;
    if (relation == Relation::nothing_left) {
      empty_ = true;
      return false;
    }
    if (relation == Relation::new_hidden) {
      face.crossed = true;
      break;
    }
    if (!old.crossed) --whole_disks_;
    old.crossed = true;
    if (relation == Relation::old_hidden) continue;
    face.crossed = true;
    edge.a = space_.active[i];
    edge.b = fresh;
    // A face none of whose edges is cut can only lose a segment between two points of its arcs.
    if (old.touched ? clip_chord(edge) : keeps_whole(edge)) push_edge(edge);
  }
  return true;
}

// Clips a new chord by all other planes; false when nothing is left.
VDWMESH_HD inline bool BallCell::clip_chord(CellEdge& edge) const {
  for (std::uint32_t i = 0; i < active_count_; ++i) {
    const std::uint32_t index = space_.active[i];
    if (index == edge.a) continue;
    const Cap& cap = space_.faces[index].cap;
    const double room = cap.cosine - inner(cap.axis, edge.middle);
    const double slope = inner(cap.axis, edge.half);
    const bool upper_out = slope * edge.upper - room > -kSlack;
    const bool lower_out = slope * edge.lower - room > -kSlack;
    if (!upper_out && !lower_out) continue;
    if (upper_out && lower_out) return false;
    const double at = end_at(edge, index, room / slope);
    if (upper_out) {
      edge.upper = at < edge.upper ? at : edge.upper;
      edge.exposed &= static_cast<std::uint8_t>(~kUpperEnd);
    } else {
      edge.lower = at > edge.lower ? at : edge.lower;
      edge.exposed &= static_cast<std::uint8_t>(~kLowerEnd);
    }
    if (!(edge.lower < edge.upper)) return false;
  }
  return true;
}

// Whether all other planes leave all of a new chord. An end that only just lies beyond one of them
// may be where they meet, and the chord may be cut off wrongly: a doubt, unless the end lies well
// beyond another.
VDWMESH_HD inline bool BallCell::keeps_whole(const CellEdge& edge) {
  bool near = false;
  for (std::uint32_t i = 0; i < active_count_; ++i) {
    const std::uint32_t index = space_.active[i];
    if (index == edge.a) continue;
    const Cap& cap = space_.faces[index].cap;
    const double middle = inner(cap.axis, edge.middle) - cap.cosine;
    const double slope = inner(cap.axis, edge.half);
    const double depth = middle + std::abs(slope);
    if (depth > kTouching) return false;
    near = near || depth > -kSlack;
  }
  if (near) doubts_ |= kThirdCircle;
  return !near;
}

// Forgets faces of which nothing is left; they cannot matter again, for the body only shrinks.
VDWMESH_HD inline void BallCell::drop_faces(std::uint32_t fresh) {
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
  if (empty_ && depth_ < kTouching) doubts_ |= depth_ < kCertain ? kVanished : kVanishing;
}

VDWMESH_HD inline void BallCell::update_reach() {
  if (!closed()) return;
  double squared = 0;
  for (std::uint32_t i = 0; i < edge_count_; ++i) {
    const CellEdge& e = space_.edges[i];
    const double s = -e.lower > e.upper ? -e.lower : e.upper;
    const double here = inner(e.middle, e.middle) + s * s * inner(e.half, e.half);
    squared = here > squared ? here : squared;
  }
  reach_ = std::sqrt(squared) + kSlack;
}

}  // namespace vdwmesh::arcs
