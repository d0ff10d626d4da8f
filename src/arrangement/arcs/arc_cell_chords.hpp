// Second half of BallCell::cut(): the edges that a new plane adds. Included by arc_cell.hpp alone.
//
// relate() compares the new disk with each disk of the body. Its answer is one of
// - crossing: the circles cross, so the planes meet in a chord. clip_chord() or keeps_whole_chord()
//   finds the part of it that the other planes leave;
// - apart: no disk reaches beyond the other plane, and both stay as they are;
// - new_hidden, old_hidden: the new or the old disk alone lies wholly beyond the other plane;
// - nothing_left: each disk lies wholly beyond the other plane, so the body is empty.
// In formulas a is the older plane, b the new one, t_a and t_b are their signed distances from the
// centre of the ball, c is the cosine between the axes.
#pragma once

#include "arrangement/arcs/arc_cell.hpp"

namespace vdwmesh::arcs {

// Two planes that are parallel to rounding (kParallel). If they face the same way, the new one is
// hidden, because caps come sorted by t and without repeated planes. If they face each other, the
// body lies in the slab between them, or is empty if the slab is.
inline BallCell::Relation BallCell::relate_parallel(const CellFace& old, const CellFace& fresh,
                                                    double cosine) {
  if (cosine > 0) return Relation::new_hidden;
  const double gap = fresh.cap.cosine + old.cap.cosine;
  if (std::abs(gap) < kParallelGap) doubts_ |= kParallelPlanes;
  return gap > 0 ? Relation::apart : Relation::nothing_left;
}

// Two circles that do not cross. Each disk lies wholly on one side of the other plane, so the side
// of its centre decides: toward_a <= 0 says that disk b lies beyond plane a, and so on.
inline BallCell::Relation BallCell::relate_uncrossed(double toward_a, double toward_b) {
  if (toward_a <= 0) return toward_b <= 0 ? Relation::nothing_left : Relation::new_hidden;
  return toward_b <= 0 ? Relation::old_hidden : Relation::apart;
}

// Decides how the circles of an old and a new plane lie. If they cross, fills `edge` with the whole
// chord, from sphere to sphere, but not its faces a and b. A unit vector x with the scalar products
// t_a, t_b with the axes exists off their plane exactly if the Gram determinant of both axes and x,
// 1 + 2 t_a t_b c - t_a² - t_b² - c² = sine_a² sine_ab² - toward_b², is positive: circles cross.
inline BallCell::Relation BallCell::relate(const CellFace& old, const CellFace& fresh,
                                           CellEdge& edge) {
  const Cap& a = old.cap;
  const Cap& b = fresh.cap;
  const double cosine = inner(a.axis, b.axis);
  // With b - a or b + a, whichever is shorter, sines near 0 and 180 degrees keep their digits.
  const double sign = cosine < 0 ? -1 : 1;
  const Vec3d apart = b.axis - sign * a.axis;
  // toward_b = t_b - c t_a, negative if the centre of disk a is beyond plane b; toward_a likewise.
  const double toward_b = (b.cosine - sign * a.cosine) - a.cosine * inner(apart, a.axis);
  const double toward_a = (a.cosine - sign * b.cosine) + sign * b.cosine * inner(apart, b.axis);
  // Most pairs of circles clearly do not cross, which shows without the cross product.
  const double rough_gram = old.squared_sine * (1 - cosine) * (1 + cosine) - toward_b * toward_b;
  if (rough_gram < -kCoarseRounding) return relate_uncrossed(toward_a, toward_b);
  const Vec3d normal = cross(a.axis, apart);
  const double squared_sine = inner(normal, normal);
  if (squared_sine < kParallel) return relate_parallel(old, fresh, cosine);
  if (squared_sine < kNearlyParallel) doubts_ |= kParallelPlanes;
  const double gram = old.squared_sine * squared_sine - toward_b * toward_b;
  if (!(gram > 0)) return relate_uncrossed(toward_a, toward_b);
  const double root = std::sqrt(gram);
  const double inverse = 1 / squared_sine;
  edge.middle = a.cosine * a.axis + (toward_b * inverse) * cross(normal, a.axis);
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

// Adds the edges of the new plane. Returns false if that leaves nothing of the body.
inline bool BallCell::add_face(std::uint32_t fresh, bool was_closed) {
  CellFace& face = space_.faces[fresh];
  CellEdge edge;
  for (std::uint32_t i = 0; i < active_count_; ++i) {
    CellFace& old = space_.faces[space_.active[i]];
    // On a polytope the new edges lie on faces that lose a corner, so the others are skipped.
    if (was_closed && !old.touched) continue;
    const Relation relation = relate(old, face, edge);
    if (relation == Relation::apart) continue;
    if (relation == Relation::nothing_left) {
      empty_ = true;
      return false;
    }
    if (relation == Relation::new_hidden) {  // so the new face has no edge
      face.crossed = true;
      break;
    }
    if (!old.crossed) --whole_disks_;
    old.crossed = true;
    if (relation == Relation::old_hidden) continue;
    face.crossed = true;
    edge.a = space_.active[i];
    edge.b = fresh;
    // If none of its edges was cut, a face can lose only a piece between an arc and a whole chord.
    if (old.touched ? clip_chord(edge) : keeps_whole_chord(edge)) push_edge(edge);
  }
  return true;
}

// Clips a new chord by all planes but its own two. Returns false if nothing is left of it.
inline bool BallCell::clip_chord(CellEdge& edge) const {
  for (std::uint32_t i = 0; i < active_count_; ++i) {
    const std::uint32_t index = space_.active[i];
    if (index == edge.a) continue;
    const Cap& cap = space_.faces[index].cap;
    // The point x(s) of the chord lies slope * s - room beyond the plane, or before it if < 0.
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

// An old face none of whose edges was cut has the whole chord or nothing of it: returns true or
// false. It has nothing if an end lies more than kTouching beyond some other plane. If an end lies
// less far beyond, or at most kSlack before, rounding decides: the chord is left out with a doubt.
inline bool BallCell::keeps_whole_chord(const CellEdge& edge) {
  bool near = false;
  for (std::uint32_t i = 0; i < active_count_; ++i) {
    const std::uint32_t index = space_.active[i];
    if (index == edge.a) continue;
    const Cap& cap = space_.faces[index].cap;
    const double middle = inner(cap.axis, edge.middle) - cap.cosine;
    const double slope = inner(cap.axis, edge.half);
    const double depth = middle + std::abs(slope);  // of the chord end farthest beyond the plane
    if (depth > kTouching) return false;
    near = near || depth > -kSlack;
  }
  if (near) doubts_ |= kThirdCircle;
  return !near;
}

}  // namespace vdwmesh::arcs
