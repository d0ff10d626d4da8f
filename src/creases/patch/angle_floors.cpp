// AngleFloors: finds the two pieces beside a small angle at a corner of the patch by walking around
// the corner, and the exact angle between their arcs from the circles.
#include "creases/patch/angle_floors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "creases/patch/patch_angles.hpp"
#include "creases/patch/patch_quality.hpp"
#include "creases/sine_cosine.hpp"

namespace vdwmesh {
namespace {

constexpr double kFloor = kFloorOfAngles * std::numbers::pi / 180;
constexpr double kEnough = 1 + kFloorMargin;  // as a multiple of a floor
// Pieces up to this fraction of the edge length are not split for floors.
constexpr double kShortestForFloors = 1e-6;
// Nor are pieces whose parts would be nearly as straight as the mesher gives up at: their sagittas
// must be so many times as large.
constexpr double kStraightForFloors = 16;

double angle_between(const Vec3d& a, const Vec3d& b) {
  return argument(dot(a, b), norm(cross(a, b)));
}

double angle_at(const PatchTriangles& patch, const LinkedTriangle& t, std::uint32_t k) {
  const Vec3d& p = patch.points[t.vertices[k]];
  return angle_between(patch.points[t.vertices[corner_after(k)]] - p,
                       patch.points[t.vertices[corner_before(k)]] - p);
}

// Whether all angles of a triangle are above the floor by more than rounding.
bool is_surely_above(const PatchTriangles& patch, const LinkedTriangle& t) {
  const Vec3d &a = patch.points[t.vertices[0]], &b = patch.points[t.vertices[1]],
              &c = patch.points[t.vertices[2]];
  const Vec3d ab = b - a, ac = c - a;
  return least_squared_sine(squared_norm(ab), squared_norm(ac), squared_norm(c - b),
                            squared_norm(cross(ab, ac))) > 1.001 * kFloorSine * kFloorSine;
}

}  // namespace

AngleFloors::AngleFloors(const PatchBoundaryView& boundary, const ArcsOfPatch& arcs,
                         double edge_length)
    : boundary_(boundary),
      chords_(boundary),
      arcs_(arcs),
      shortest_(kShortestForFloors * edge_length) {}

// Nearly all triangles end at the sine of their least angle, which needs no argument.
template <class Visit>
bool AngleFloors::visit_below(const PatchTriangles& patch, const Visit& visit) const {
  for (std::uint32_t t = 0; t < patch.triangles.size(); ++t) {
    const LinkedTriangle& w = patch.triangles[t];
    if (is_surely_above(patch, w)) continue;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const double angle = angle_at(patch, w, k);
      if (angle >= kFloor * kEnough || angle >= floor_at(patch, t, k) * kEnough) continue;
      if (visit(w, k)) return true;
    }
  }
  return false;
}

bool AngleFloors::has_angle_below(const PatchTriangles& patch) const {
  return visit_below(patch, [](const LinkedTriangle&, std::uint32_t) { return true; });
}

std::uint64_t AngleFloors::count(const PatchTriangles& patch) const {
  std::uint64_t below = 0;
  visit_below(patch, [&](const LinkedTriangle&, std::uint32_t) {
    ++below;
    return false;
  });
  return below;
}

// An angle is opposite to an edge e. For the sine s of the floor, the edges beside it must be as
// short as e / s, or nearly. Where this is shorter than half of the shortest piece that is split,
// as over arcs of 1e-8 of the edge length, splits would only make more such angles.
void AngleFloors::find(const PatchTriangles& patch, PatchVector<PieceSplit>& found) const {
  visit_below(patch, [&](const LinkedTriangle& t, std::uint32_t k) {
    const double opposite = norm(patch.points[t.vertices[corner_after(k)]] -
                                 patch.points[t.vertices[corner_before(k)]]);
    if (2 * opposite > kFloorSine * shortest_) ask(t, k, found);
    return false;
  });
}

// The fan of triangles around the vertex is bounded by the piece that leaves it, clockwise, and the
// one that comes to it, counter-clockwise. A vertex inside the patch has a whole fan and no floor
// of its own.
double AngleFloors::floor_at(const PatchTriangles& patch, std::uint32_t t, std::uint32_t k) const {
  const std::uint32_t v = patch.triangles[t].vertices[k];
  if (v >= boundary_.points.size()) return kFloor;
  // From a triangle at v over its edge on one side of v, on to the next one.
  const auto walk_on = [&](std::uint32_t& at, const auto& edge_after) {
    const LinkedTriangle& w = patch.triangles[at];
    const std::uint32_t edge = edge_after(w.corner_at(v));
    if (w.pieces[edge] == kNoPiece) at = w.neighbors[edge];
    return w.pieces[edge];
  };
  std::uint32_t at = t, leaving = kNoPiece, coming = kNoPiece;
  for (std::size_t i = 0; i < patch.triangles.size() && leaving == kNoPiece; ++i) {
    leaving = walk_on(at, corner_before);
  }
  double flat = 0;
  for (std::size_t i = 0; i < patch.triangles.size() && coming == kNoPiece; ++i) {
    const LinkedTriangle& w = patch.triangles[at];
    flat += angle_at(patch, w, w.corner_at(v));
    coming = walk_on(at, corner_after);
  }
  if (leaving == kNoPiece || coming == kNoPiece) return kFloor;
  return std::min(kFloor, exact_angle(leaving, coming, flat) / 2);
}

// A tangent of the piece's circle at one of its ends, into the piece. With growing angle, an arc
// runs along -sin · `cosine` + cos · `sine`, with the patch of its second ball on its left.
Vec3d AngleFloors::direction_along(std::uint32_t piece, bool from_its_end) const {
  const ArcPiece source = boundary_.pieces[piece].source;
  const BoundaryArc& arc = arcs_.boundary.arcs[source.arc];
  const bool backwards = arc.balls[0] == arcs_.ball, is_later = backwards != from_its_end;
  const double part = arcs_.sampling.part(source.arc, source.piece + (is_later ? 1 : 0));
  const SineCosine at = sine_cosine(arc.sweep * part);
  const Vec3d along = at.cosine * arc.sine - at.sine * arc.cosine;
  return is_later ? -1.0 * along : along;
}

// `flat`: the angle between the chords. An angle of nothing may come out as a whole turn.
double AngleFloors::exact_angle(std::uint32_t leaving, std::uint32_t coming, double flat) const {
  const Vec3d& apex = boundary_.points[boundary_.pieces[leaving].from];
  const double angle = turn(apex, direction_along(leaving, false), direction_along(coming, true));
  return angle > 1.5 * std::numbers::pi && flat < std::numbers::pi / 2 ? 0 : angle;
}

// If two edges of the triangle are pieces, they meet in a corner. Of others, a piece opposite to
// the small angle is too short already, and the pieces beside it are too long.
void AngleFloors::ask(const LinkedTriangle& t, std::uint32_t k,
                      PatchVector<PieceSplit>& found) const {
  for (const std::uint32_t corner : {corner_after(k), corner_before(k), k}) {
    if (t.pieces[corner_after(corner)] != kNoPiece && t.pieces[corner_before(corner)] != kNoPiece)
      return ask_at_corner(t, k, corner, found);
  }
  std::uint32_t longest = chords_.longer(t.pieces[corner_after(k)], t.pieces[corner_before(k)]);
  if (longest == kNoPiece) longest = chords_.longest_at_vertices(t, t.pieces[k]);
  if (longest != kNoPiece) halve(longest, found);
}

// The corner's own angle differs from the exact one by what the arcs bulge, which halves shrink. If
// another angle is too small, the pieces are of too different length, or the corner is too wide.
void AngleFloors::ask_at_corner(const LinkedTriangle& t, std::uint32_t k, std::uint32_t corner,
                                PatchVector<PieceSplit>& found) const {
  const std::uint32_t one = t.pieces[corner_after(corner)], other = t.pieces[corner_before(corner)];
  if (k == corner) {
    halve(one, found);
    halve(other, found);
    return;
  }
  const std::uint32_t longer = chords_.of(one) > chords_.of(other) ? one : other;
  const double shorter_chord = std::min(chords_.of(one), chords_.of(other)),
               ratio = chords_.of(longer) / shorter_chord;
  const Vec3d& p = boundary_.points[t.vertices[corner]];
  const double angle = angle_between(boundary_.points[t.vertices[corner_after(corner)]] - p,
                                     boundary_.points[t.vertices[corner_before(corner)]] - p);
  const bool is_sharp = angle < kSharpCorner * std::numbers::pi / 180;
  if (is_sharp && ratio < 1.001 * kCornerRatio) {
    cut(longer, t.vertices[corner], shorter_chord, found);
  } else {
    halve(longer, found);
  }
}

void AngleFloors::halve(std::uint32_t piece, PatchVector<PieceSplit>& found) const {
  if (may_split(piece, 0.5)) found.push_back({boundary_.pieces[piece].source, 1});
}

// Cuts a piece so that its part at `point` has a chord of this length on the unit sphere. A chord
// of a circle of radius c over the angle x is 2 c sin(x / 2) long. The piece's own chord is longer,
// and x at most an eighth of a turn (kLeastPiecesOfCircle).
void AngleFloors::cut(std::uint32_t piece, std::uint32_t point, double length,
                      PatchVector<PieceSplit>& found) const {
  const BoundaryPiece& p = boundary_.pieces[piece];
  const BoundaryArc& arc = arcs_.boundary.arcs[p.source.arc];
  const double sine = length * arcs_.radius / (2 * arc.radius);
  const double angle = 2 * argument(std::sqrt((1 - sine) * (1 + sine)), sine);
  const double fraction = angle / arcs_.sampling.piece_angle(p.source);
  if (!may_split(piece, std::min(fraction, 1 - fraction))) return;
  const bool backwards = arc.balls[0] == arcs_.ball, from_first = backwards == (point == p.to);
  const double first = 0x1p32 * (from_first ? fraction : 1 - fraction);
  found.push_back({p.source, 1, static_cast<std::uint32_t>(first)});
}

// The shorter part is as long as this fraction of the piece, or nearly, and its sagitta is the
// square of it. No part is shorter than a half of the shortest piece that is halved; so a fraction
// is above 2e-7, far more than the 2^-32 that PieceSplit counts in.
bool AngleFloors::may_split(std::uint32_t piece, double fraction) const {
  const ArcPiece source = boundary_.pieces[piece].source;
  return 2 * fraction * chords_.of(piece) > shortest_ &&
         !arcs_.limits.is_straight(source, kStraightForFloors / (fraction * fraction)) &&
         arcs_.limits.has_room_for_angles(source.arc);
}

}  // namespace vdwmesh
