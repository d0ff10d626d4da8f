// AngleBound: finds the sharp corners of a patch from the pieces that meet in each point of its
// boundary, and for each triangle below the bound the piece that its circumcentre sees under the
// widest angle, or that parts the two.
#include "creases/patch/patch_angles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "creases/patch/patch_quality.hpp"
#include "measures/arcs/arguments.hpp"

namespace vdwmesh {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMargin = 3;  // degrees; see AngleBound::sine_before_smoothing()

}  // namespace

double argument(double re, double im) { return arcs::arguments(all_lanes(re), all_lanes(im))[0]; }

double turn(const Vec3d& apex, const Vec3d& a, const Vec3d& b) {
  return argument(dot(a, b) - dot(apex, a) * dot(apex, b), dot(apex, cross(a, b)));
}

std::uint32_t PieceChords::longest_at_vertices(const LinkedTriangle& t, std::uint32_t but) const {
  if (at_points_.size() == 0) {
    at_points_.fill(boundary_.points.size(), [&](const auto& visit) {
      for (std::uint32_t p = 0; p < boundary_.pieces.size(); ++p) {
        visit(boundary_.pieces[p].from, p);
        visit(boundary_.pieces[p].to, p);
      }
    });
  }
  std::uint32_t longest = kNoPiece;
  for (const std::uint32_t v : t.vertices) {
    if (v >= at_points_.size()) continue;  // inside the patch
    for (const std::uint32_t p : at_points_[v]) {
      if (p == but || p == longest) continue;
      longest = p < longest ? longer(p, longest) : longer(longest, p);
    }
  }
  return longest;
}

AngleBound::AngleBound(const PatchBoundaryView& boundary, double angle, double edge_length)
    : boundary_(boundary),
      chords_(boundary),
      sine_(std::sin(angle)),
      sine_before_smoothing_(std::sin(angle + kDegree * kMargin)),
      shortest_(kShortestForAngles * edge_length) {
  find_sharp_corners();
}

void AngleBound::take(std::uint32_t piece, PatchVector<PieceSplit>& found) const {
  if (piece != kNoPiece && chords_.of(piece) > shortest_)
    found.push_back({boundary_.pieces[piece].source, 1});
}

// The patch is on the left of its pieces. So at a point it is between the piece that leaves it and,
// counter-clockwise, the piece that comes to it. Where corners were joined, several pieces come and
// go; of those that come, the next one counter-clockwise belongs to the one that leaves. An arc
// that bulges into the patch takes its bulge from the angle between the chords. On both sides of a
// point inside of an arc the angle is half a turn.
void AngleBound::find_sharp_corners() {
  constexpr double kLargest = kSharpCorner * kDegree;
  const auto count = static_cast<std::uint32_t>(boundary_.pieces.size());
  std::vector<std::uint32_t> coming(count);
  for (std::uint32_t p = 0; p < count; ++p) coming[p] = p;
  const auto end_of = [&](std::uint32_t p) { return boundary_.pieces[p].to; };
  std::ranges::stable_sort(coming, {}, end_of);
  for (std::uint32_t p = 0; p < count; ++p) {
    const BoundaryPiece& leaving = boundary_.pieces[p];
    const Vec3d& apex = boundary_.points[leaving.from];
    double least = 2 * std::numbers::pi;
    std::uint32_t next = p;
    for (const std::uint32_t q : std::ranges::equal_range(coming, leaving.from, {}, end_of)) {
      const BoundaryPiece& other = boundary_.pieces[q];
      const double angle =
          turn(apex, boundary_.points[leaving.to] - apex, boundary_.points[other.from] - apex) -
          leaving.bulge - other.bulge;
      if (angle >= least) continue;
      least = angle;
      next = q;
    }
    if (!(least < kLargest)) continue;
    // A little more, since rounding must not excuse one of two triangles that are mirror images.
    const double reach = (1 + 1e-6) * kShells * std::max(chords_.of(p), chords_.of(next));
    sharp_.push_back({apex, reach * reach});
  }
}

AngleBound::Verdict AngleBound::judge(const std::array<Vec3d, 3>& p) const {
  const Vec3d a = p[1] - p[0], b = p[2] - p[0];
  const double squared_sine = least_squared_sine(
      squared_norm(a), squared_norm(b), squared_norm(p[2] - p[1]), squared_norm(cross(a, b)));
  if (squared_sine >= sine_ * sine_) return Verdict::fine;
  const bool is_excused = std::ranges::any_of(sharp_, [&](const SharpCorner& corner) {
    return std::ranges::all_of(p, [&](const Vec3d& vertex) {
      return squared_norm(vertex - corner.position) <= corner.squared_reach;
    });
  });
  return is_excused ? Verdict::excused : Verdict::small;
}

void AngleBound::find_in_plane(PlaneTriangulation& plane, std::span<const Vec3d> points,
                               const Stereographic& projection,
                               PatchVector<PieceSplit>& found) const {
  const auto count = static_cast<std::uint32_t>(plane.triangles().size());
  for (std::uint32_t t = 0; t < count; ++t) {
    if (!plane.is_inside(t)) continue;
    const auto& v = plane.triangle(t).vertices;
    if (judge({points[v[0]], points[v[1]], points[v[2]]}) != Verdict::small) continue;
    take(piece_in_the_way(plane, points, projection, t), found);
  }
}

// Of the pieces around the triangles that the circumcentre would replace, one with the circumcentre
// on its other side comes first; of several, the one seen under the widest angle. If there is none,
// the widest one counts if it is wide enough to keep the circumcentre out, by the same angle as in
// PatchTriangulator::encroaches(), which needs no piece and therefore no quotient.
std::uint32_t AngleBound::piece_in_the_way(PlaneTriangulation& plane, std::span<const Vec3d> points,
                                           const Stereographic& projection, std::uint32_t t) const {
  const auto& v = plane.triangle(t).vertices;
  const Vec3d u = circumcenter({points[v[0]], points[v[1]], points[v[2]]});
  const PlanePoint p = projection.project(u);
  // Near the pole, far from the patch, it has no place in the plane.
  if (plane.locate(p, t).place == PlaneTypes::Place::outside) {
    return longest_piece_at(plane.triangle(t));
  }
  std::uint32_t chosen = kNoPiece;
  bool is_beyond = false;
  double widest = kWidestView;
  for (const auto& [at, k] : plane.pieces_around(p, t)) {
    const LinkedTriangle& w = plane.triangle(at);
    const Vec3d &a = points[w.vertices[corner_after(k)]], &b = points[w.vertices[corner_before(k)]];
    // The triangle is on the left of its edge from a to b.
    const bool beyond = dot(cross(a, b), u) < 0;
    const Vec3d to_a = a - u, to_b = b - u;
    const double cosine = dot(to_a, to_b) / std::sqrt(squared_norm(to_a) * squared_norm(to_b));
    if (beyond == is_beyond ? !(cosine < widest) : !beyond) continue;
    chosen = w.pieces[k];
    is_beyond = beyond;
    widest = cosine;
  }
  return chosen;
}

void AngleBound::find_in_patch(const PatchTriangles& patch, PatchVector<PieceSplit>& found) const {
  for (const LinkedTriangle& t : patch.triangles) {
    const auto& v = t.vertices;
    if (judge({patch.points[v[0]], patch.points[v[1]], patch.points[v[2]]}) != Verdict::small) {
      continue;
    }
    take(longest_piece_at(t), found);
  }
}

std::uint32_t AngleBound::longest_piece_at(const LinkedTriangle& t) const {
  std::uint32_t longest = kNoPiece;
  for (const std::uint32_t piece : t.pieces) longest = chords_.longer(longest, piece);
  return longest != kNoPiece ? longest : chords_.longest_at_vertices(t);
}

SmallAngles AngleBound::count(const PatchTriangles& patch) const {
  SmallAngles small;
  for (const LinkedTriangle& t : patch.triangles) {
    const auto& v = t.vertices;
    const Verdict verdict = judge({patch.points[v[0]], patch.points[v[1]], patch.points[v[2]]});
    small.at_corners += verdict == Verdict::excused;
    small.elsewhere += verdict == Verdict::small;
  }
  return small;
}

}  // namespace vdwmesh
