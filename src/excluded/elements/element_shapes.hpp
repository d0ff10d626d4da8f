// Shapes and measures of arcs, saddles and whole concave patches, in double. For the library's own
// use, on the host and on a CUDA device. The formulas are those of excluded_measures().
//
// Balls are those grown by the probe. A probe at a corner touches three of them; its concave patch
// is a polygon on the probe whose corners are the points of contact. `sixths` is six times an Euler
// characteristic: of a crease each of two patches counts a half, and of a point where creases meet
// each of three patches a third.
#pragma once

#include "excluded/elements/elements.hpp"
#include "excluded/patches/patch_sides.hpp"
#include "excluded/patches/share_formulas.hpp"

namespace vdwmesh::excluded::elements {

inline constexpr double kPi = std::numbers::pi;

// The direction of `arm` at right angles to the axis; any such direction if `arm` lies along it.
VDWMESH_HD inline Vec3d flattened(const Vec3d& arm, const Vec3d& axis) {
  const Vec3d flat = arm - dot(arm, axis) * axis;
  return squared_norm(flat) > 0 ? unit(flat) : any_orthogonal(axis);
}

VDWMESH_HD inline ArcShape arc_shape(const Balls& balls, const ProbeCorner* corners,
                                     const Arc& arc) {
  const Sphere &a = balls.grown[arc.ball[0]], &b = balls.grown[arc.ball[1]];
  const PairCircle circle = pair_circle(a, b);
  ArcShape s{};
  s.axis = circle.axis;
  s.circle_radius = circle.radius;
  s.height[0] = circle.height[0];
  s.height[1] = circle.height[1];
  const double p = balls.probe, rho = circle.radius;
  s.spindle = rho < p && s.height[0] > 0 && s.height[1] > 0;
  s.cusp_height = s.spindle ? std::sqrt((p - rho) * (p + rho)) : 0;
  s.angle = 2 * kPi;
  if (arc.is_ring()) return s;
  for (int end = 0; end < 2; ++end) {
    const ProbeCorner& corner = corners[arc.corner[end]];
    const Vec3d base = balls.grown[corner.name.ball[0]].center - a.center;
    s.radial[end] = flattened((base + corner.at) - s.height[0] * s.axis, s.axis);
  }
  const double angle =
      std::atan2(triple_product(s.axis, s.radial[0], s.radial[1]), dot(s.radial[0], s.radial[1]));
  // The arctangent is short of a whole turn where it is negative. Near 0 rounding decides its sign,
  // but the rough length tells a tiny arc from all but a whole circle.
  constexpr double kClose = 1e-3;  // rad
  s.angle = angle;
  if (std::abs(angle) < kClose ? arc.turns > 2 : angle < 0) s.angle += 2 * kPi;
  return s;
}

// What the ball on one side of an arc, 0 or 1, gets of its saddle, and of the arc as a boundary of
// its contact piece.
//
// In the Euler characteristic an arc that is no ring counts -1 for its edge on each contact piece,
// and 1 for the face of the saddle, which side 0 has. A spindle's saddle falls into two faces, one
// on each side, which end in cusps: all arcs of one circle share the two cusps, which go to the
// first arc. The cusp of a ring lies inside its face, a disk, and is no vertex.
VDWMESH_HD inline ElementShare saddle_terms(const Balls& balls, const Arc& arc,
                                            const ArcShape& shape, bool first_on_circle, int side,
                                            const Vec3d& home) {
  ElementShare t{};
  const auto k = static_cast<std::size_t>(side);
  const SaddleMeasures m = measure_saddle(shape, balls.probe, profile_of(shape), k);
  const Sphere &a = balls.grown[arc.ball[0]], &own = balls.grown[arc.ball[side]];
  const Vec3d at = (a.center - home) + shape.height[0] * shape.axis;
  t.saddle = m.area;
  t.layer = m.layer;
  t.normal = m.vector;
  t.flux = m.flux + dot(at, m.vector) / 3;
  t.bend = -shape.angle * (shape.height[k] / own.radius);
  t.contact = contact_vector(shape, k, own.radius);
  const bool ring = arc.is_ring();
  if (!ring) t.sixths -= 6;
  if (shape.spindle) {
    t.sixths += 6;
    if (first_on_circle) {
      ++t.cusps;
      if (!ring) t.sixths += 6;
    }
  } else if (side == 0 && !ring) {
    t.sixths += 6;
  }
  if (side == 0) {
    t.arcs = 1;
    t.rings = ring;
    t.spindles = shape.spindle;
  }
  return t;
}

// The polygon of a corner.
struct Polygon {
  PatchSide side[3];
  double solid_angle;
  Vec3d vector;       // ∫ w dω
  Vec3d touch[3];     // unit vectors to the balls
  double turning[3];  // of the contact pieces of the balls
  Vec3d apex;         // as far from all three points of contact
};

// The angle by which the boundary of the contact piece of ball o turns at a point x of its sphere,
// where it goes over from the circle of p to that of q.
VDWMESH_HD inline double turning_angle(const Vec3d& ox, const Vec3d& op, const Vec3d& oq) {
  const Vec3d n = cross(ox, op), m = cross(ox, oq);
  return std::atan2(norm(ox) * std::abs(triple_product(op, oq, ox)), dot(n, m));
}

// The slot, 0 to 2, of one of a corner's balls.
VDWMESH_HD inline int place_in(const CornerName& name, std::uint32_t ball) {
  return name.ball[0] == ball ? 0 : (name.ball[1] == ball ? 1 : 2);
}

// The vector from the point of contact with ball j to that with ball i, at right angles to the
// plane that bisects them. It is formed as in atom_shares.cpp, so that balls that all but coincide
// lose no digits.
VDWMESH_HD inline Vec3d between_contacts(const Balls& balls, const ProbeCorner& corner,
                                         const Polygon& polygon, int i, int j) {
  const Sphere &a = balls.grown[corner.name.ball[i]], &b = balls.grown[corner.name.ball[j]];
  return (1 / a.radius) * ((a.center - b.center) + (b.radius - a.radius) * polygon.touch[j]);
}

VDWMESH_HD inline Polygon corner_polygon(const Balls& balls, const ProbeCorner& corner,
                                         const Arc* arcs, const ArcShape* shapes) {
  Polygon g{};
  Vec3d arm[3];  // from the probe to the balls
  const Vec3d& base = balls.grown[corner.name.ball[0]].center;
  for (int k = 0; k < 3; ++k) {
    arm[k] = (balls.grown[corner.name.ball[k]].center - base) - corner.at;
    g.touch[k] = unit(arm[k]);
  }
  g.solid_angle = -kPi;
  for (int k = 0; k < 3; ++k) {
    const Vec3d ox = -1.0 * arm[k];
    const Vec3d& own = balls.grown[corner.name.ball[k]].center;
    g.turning[k] = turning_angle(ox, balls.grown[corner.name.ball[(k + 1) % 3]].center - own,
                                 balls.grown[corner.name.ball[(k + 2) % 3]].center - own);
    g.solid_angle += g.turning[k];
  }
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t at = corner.arc[k];
    const Arc& arc = arcs[at];
    PatchSide& s = g.side[k];
    s = patch_side(shapes[at], at, static_cast<ArcEnd>(corner.end[k]), arc.ball[0], arc.ball[1],
                   balls.probe);
    s.turning = kPi - g.turning[place_in(corner.name, s.atom[1])];
    g.vector = g.vector + (0.5 * (s.angle[0] + s.angle[1])) * s.inward;
  }
  g.apex =
      cross(between_contacts(balls, corner, g, 1, 0), between_contacts(balls, corner, g, 2, 0));
  const double size = norm(g.apex);
  g.apex = size > 0 ? (1 / size) * g.apex : g.touch[0];
  if (dot(g.apex, g.touch[0]) < 0) g.apex = -1.0 * g.apex;
  return g;
}

// Cuts an arc where it crosses the bisecting planes, and adds the fan over each part to the solid
// angle of the ball whose point of contact is nearest.
VDWMESH_HD inline void share_arc(const Balls& balls, const ProbeCorner& corner,
                                 const Polygon& polygon, const SphereArc& arc, double (&share)[3]) {
  double cut[8] = {0};
  int count = 1;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    cross_plane(arc, between_contacts(balls, corner, polygon, i, j), [&](double fraction) {
      int place = count++;
      for (; cut[place - 1] > fraction; --place) cut[place] = cut[place - 1];
      cut[place] = fraction;
    });
  }
  cut[count] = 1;
  for (int k = 0; k < count; ++k) {
    const Vec3d w = arc.at((cut[k] + cut[k + 1]) / 2);
    int nearest = 0;
    for (int i = 1; i < 3; ++i) {
      if (dot(between_contacts(balls, corner, polygon, i, nearest), w) > 0) nearest = i;
    }
    share[nearest] += fan(polygon.apex, arc, cut[k], cut[k + 1]);
  }
}

// A concave patch, cut by creases or whole, on a probe of radius 1.
struct PatchMeasures {
  double solid_angle;
  Vec3d vector;     // ∫ w dω
  double share[3];  // of the solid angle, for each of its balls
  double flat[3];   // likewise, three times the volume of the cones over the flat faces of creases
  std::uint64_t creases;
  std::int32_t sixths;
  std::uint32_t crease_arcs;
};

VDWMESH_HD inline PatchMeasures whole_patch(const Balls& balls, const ProbeCorner& corner,
                                            const Polygon& polygon) {
  PatchMeasures m{};
  m.solid_angle = polygon.solid_angle;
  m.vector = polygon.vector;
  m.sixths = 6;
  for (const PatchSide& s : polygon.side) {
    share_arc(balls, corner, polygon, {s.inward, 0, s.contact[0], s.angle[0] + s.angle[1]},
              m.share);
  }
  return m;
}

// What the ball in one slot of a corner gets of the concave patch, and of the corner as a corner of
// its contact piece. The ball in slot 0 also gets what is not divided among the balls.
VDWMESH_HD inline ElementShare corner_terms(const Balls& balls, const ProbeCorner& corner,
                                            const PatchMeasures& patch, double turning, int slot,
                                            const Vec3d& home) {
  const double p = balls.probe;
  ElementShare t{};
  t.concave = p * p * patch.share[slot];
  t.layer = p * p * p * (patch.share[slot] + patch.flat[slot]) / 3;
  t.bend = turning;
  if (slot > 0) return t;
  const Vec3d x = (balls.grown[corner.name.ball[0]].center - home) + corner.at;
  t.normal = (-p * p) * patch.vector;
  t.flux = -p * p * (dot(x, patch.vector) + p * patch.solid_angle) / 3;
  t.creases = patch.creases;
  t.sixths = patch.sixths;
  t.crease_arcs = static_cast<std::uint16_t>(patch.crease_arcs);
  t.probes = 1;
  t.low_probes = corner.low;
  return t;
}

}  // namespace vdwmesh::excluded::elements
