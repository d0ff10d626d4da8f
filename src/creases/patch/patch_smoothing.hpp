// Smooths the triangles of a patch, and finds the pieces that make triangles invalid.
//
// Smoothing is Laplacian with a quality test ("smart"): a point moves towards the centroid of its
// triangles only if the least angle around it grows. Edges are flipped by the local Delaunay
// criterion on the flat triangles: the two angles opposite to an edge must not add up to more than
// half a turn. patch_triangulator.hpp calls smooth() and then find_defects() at the end of a patch.
//
// The templates are for plane_triangulation.cpp, which compiles them for the host, and for the
// kernels of the device.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "creases/patch/patch_quality.hpp"
#include "creases/plane/patch_triangles.hpp"
#include "creases/sine_cosine.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh {
namespace smoothing {

// The fraction of a flat triangle's angle that must remain when arcs replace the chords beside it.
inline constexpr double kLeastAngleShare = 0.3;

// Whether the triangle a, b, c is counter-clockwise seen from outside, so that its normal points
// away from the sphere's centre. The sign of a · (b × c) says the same, but it cancels for small
// triangles; differences of nearby points keep their digits.
VDWMESH_HD inline bool faces_outwards(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return dot(a, cross(b - a, c - a)) > 0;
}

// A triangle p, a, b, of which p may move.
struct StarTriangle {
  Vec3d pa, pb, ab, normal;  // edges, and the normal, twice as long as the area is large

  VDWMESH_HD StarTriangle(const Vec3d& p, const Vec3d& a, const Vec3d& b)
      : pa(a - p), pb(b - p), ab(b - a), normal(cross(pa, pb)) {}

  VDWMESH_HD double least_squared_sine() const {
    return vdwmesh::least_squared_sine(squared_norm(pa), squared_norm(pb), squared_norm(ab),
                                       squared_norm(normal));
  }
};

// Whether the angles at a and d, opposite to the common edge bc, add up to more than half a turn.
// Then the edge is not locally Delaunay. For angles α and δ of two triangles, this holds if and
// only if sin(α + δ) < 0, because each is less than half a turn.
VDWMESH_HD inline bool exceed_half_turn(const Vec3d& a, const Vec3d& b, const Vec3d& c,
                                        const Vec3d& d) {
  // Relative. Without it, rounding would decide about four co-circular points, and could flip their
  // edge to and fro for ever. As large as the ties of the triangulation (kTie in
  // plane_insertion.hpp).
  constexpr double kSlack = 1e-8;
  const Vec3d ab = b - a, ac = c - a, db = b - d, dc = c - d;
  const double cosine_a = dot(ab, ac), cosine_d = dot(db, dc);
  // Both angles are at most a right angle, so their sum is at most half a turn.
  if (cosine_a >= 0 && cosine_d >= 0) return false;
  const double sine_a = norm(cross(ab, ac)), sine_d = norm(cross(db, dc));
  // sin(α + δ), times the lengths of the four outer edges.
  return sine_a * cosine_d + cosine_a * sine_d <
         -kSlack * (sine_a + std::abs(cosine_a)) * (sine_d + std::abs(cosine_d));
}

// Whether `taken` (rad) is so much of the angle at `apex` that less than kLeastAngleShare is left.
//
// An angle is at least as large as its sine, and at least 1 rad if its cosine is negative. If that
// is enough already, nothing else is computed. Else the angle is compared with x = taken / (1 -
// kLeastAngleShare), by the sign of the sine of their difference; both are at most half a turn.
VDWMESH_HD inline bool uses_up(double taken, const Vec3d& apex, const Vec3d& a, const Vec3d& b) {
  const Vec3d u = a - apex, v = b - apex;
  const double lengths = squared_norm(u) * squared_norm(v);
  const double squared_sine = dot(u, v) < 0 ? lengths : squared_norm(cross(u, v));
  const double share = 1 - kLeastAngleShare;
  if (taken * taken * lengths < share * share * squared_sine * (1 - 1e-9)) return false;
  constexpr double kHalfTurn = 3.141592653589793;
  const double x = taken / share;
  if (x >= kHalfTurn) return true;
  const SineCosine of_x = sine_cosine(x);
  // Two points in one place give 0 on both sides, and no angle to be used up.
  return norm(cross(u, v)) * of_x.cosine <= dot(u, v) * of_x.sine;
}

// Smooths in place; see smooth() in the header.
template <class Memory>
class Smoother {
 public:
  VDWMESH_HD Smoother(const PatchBoundaryView& boundary, const PointCirclesOf<Memory>& circles,
                      SmoothingScratchOf<Memory>& scratch, PatchTrianglesOf<Memory>& patch)
      : first_interior_(static_cast<std::uint32_t>(boundary.points.size())),
        circles_(circles),
        points_(patch.points),
        triangles_(patch.triangles),
        stars_(scratch.stars),
        changed_(scratch.changed),
        sweep_(scratch.sweep) {}

  VDWMESH_HD void run(int passes) {
    for (int pass = 0; pass < passes; ++pass) {
      index_stars();
      for (std::uint32_t v = first_interior_; v < points_.size(); ++v) move(v);
      make_delaunay();
    }
  }

 private:
  // Lists the triangles around each vertex, its star. Flips change the stars, so they are listed
  // anew in each pass.
  VDWMESH_HD void index_stars() {
    stars_.fill(points_.size(), [&](const auto& visit) {
      for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
        for (const std::uint32_t v : triangles_[t].vertices) visit(v, t);
      }
    });
  }

  // The two other vertices of a triangle around v, counter-clockwise.
  VDWMESH_HD std::array<const Vec3d*, 2> others(std::uint32_t v, std::uint32_t of) const {
    const LinkedTriangle& t = triangles_[of];
    const std::uint32_t k = t.corner_at(v);
    return {&points_[t.vertices[corner_after(k)]], &points_[t.vertices[corner_before(k)]]};
  }

  // Whether all triangles around vertex v would face outwards if v were at p, and all their angles
  // would have squared sines above `enough`.
  VDWMESH_HD bool is_better(std::uint32_t v, const Vec3d& p, double enough) const {
    for (const std::uint32_t i : stars_[v]) {
      const auto [a, b] = others(v, i);
      const StarTriangle t(p, *a, *b);
      if (!(dot(p, t.normal) > 0) || !(t.least_squared_sine() > enough)) return false;
    }
    return true;
  }

  // Moves vertex v to the mean of the centroids of its triangles, weighted by area and scaled to
  // the sphere. If that does not enlarge the least angle, the middle between the old and the new
  // position is tried; if that fails too, v stays. If a triangle faces inwards, it is enough that
  // all face outwards afterwards.
  VDWMESH_HD void move(std::uint32_t v) {
    const Vec3d old = points_[v];
    Vec3d sum{0, 0, 0};
    double least = 1;
    for (const std::uint32_t i : stars_[v]) {
      const auto [a, b] = others(v, i);
      const StarTriangle t(old, *a, *b);
      sum = sum + norm(t.normal) * (old + *a + *b);
      least = dot(old, t.normal) > 0 ? std::min(least, t.least_squared_sine()) : -1;
    }
    if (!(squared_norm(sum) > 0)) return;
    const Vec3d p = unit(sum);
    if (is_better(v, p, least)) {
      points_[v] = p;
      return;
    }
    const Vec3d middle = unit(p + old);
    if (is_better(v, middle, least)) points_[v] = middle;
  }

  // Flips an edge of triangle t if it is not locally Delaunay, both new triangles face outwards,
  // and the new edge does not join two points of one circle. Returns whether the edge was flipped.
  VDWMESH_HD bool flip_if_better(std::uint32_t t, std::uint32_t k) {
    const LinkedTriangle& one = triangles_[t];
    const std::uint32_t n = one.neighbors[k];
    if (n == kNoNeighbor) return false;
    const LinkedTriangle& two = triangles_[n];
    const std::uint32_t a = one.vertices[k], b = one.vertices[corner_after(k)],
                        c = one.vertices[corner_before(k)],
                        d = two.vertices[two.corner_opposite(t)];
    const Vec3d &pa = points_[a], &pb = points_[b], &pc = points_[c], &pd = points_[d];
    if (!exceed_half_turn(pa, pb, pc, pd)) return false;
    if (!faces_outwards(pa, pb, pd) || !faces_outwards(pa, pd, pc)) return false;
    if (circles_.share(a, d)) return false;
    flip(triangles_.data(), t, k);
    return true;
  }

  // Flips edges until nothing changes: first goes through all triangles, then again and again
  // through those that have changed since. In one plane flips are sure to come to an end; these
  // triangles do not lie in one plane, so the number of sweeps is limited. The sweeps may stop at
  // any time, because each flip leaves two triangles that face outwards.
  VDWMESH_HD void make_delaunay() {
    constexpr int kMostSweeps = 16;
    changed_.clear();
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        // Each edge once, from its triangle of lower number. (kNoNeighbor is the largest number.)
        if (triangles_[t].neighbors[k] > t) flip_and_note(t, k);
      }
    }
    for (int sweep = 1; !changed_.empty() && sweep < kMostSweeps; ++sweep) {
      std::swap(changed_, sweep_);
      changed_.clear();
      for (const std::uint32_t t : sweep_) {
        for (std::uint32_t k = 0; k < 3; ++k) flip_and_note(t, k);
      }
    }
  }

  VDWMESH_HD void flip_and_note(std::uint32_t t, std::uint32_t k) {
    const std::uint32_t n = triangles_[t].neighbors[k];
    if (!flip_if_better(t, k)) return;
    changed_.push_back(t);
    changed_.push_back(n);
  }

  // Points from this number on may move.
  std::uint32_t first_interior_;
  const PointCirclesOf<Memory>& circles_;
  typename Memory::template Array<Vec3d>& points_;
  typename Memory::template Array<LinkedTriangle>& triangles_;
  RowListsOf<Memory>& stars_;  // scratch, as the others
  typename Memory::template Array<std::uint32_t>&changed_, &sweep_;
};

// Collects the pieces to split, triangle by triangle; see find_defects() in the header.
template <class Memory>
class DefectFinder {
 public:
  using Pieces = typename Memory::template Array<std::uint32_t>;

  // Appends to `found`.
  VDWMESH_HD DefectFinder(const PatchBoundaryView& boundary, const PatchTrianglesOf<Memory>& patch,
                          Pieces& found)
      : boundary_(boundary), patch_(patch), found_(found) {}

  // Returns whether any angle of a triangle is smaller than kFloorOfAngles.
  VDWMESH_HD bool run() {
    bool has_small_angle = false;
    for (const LinkedTriangle& t : patch_.triangles) {
      const Vec3d &a = at(t, 0), &b = at(t, 1), &c = at(t, 2);
      const Vec3d ab = b - a, ac = c - a, normal = cross(ab, ac);
      // As faces_outwards().
      if (!(dot(a, normal) > 0)) {
        split_around(t);
        continue;
      }
      if (may_be_small(ab, ac, normal)) has_small_angle |= is_small(a, b, c);
      find_folds(t);
    }
    return has_small_angle;
  }

 private:
  VDWMESH_HD const Vec3d& at(const LinkedTriangle& t, std::size_t k) const {
    return patch_.points[t.vertices[k]];
  }
  // Whether an angle of the triangle may be below the floor; a cheap test, by which for nearly all
  // triangles none is.
  // The squared sine of the least angle is that of the normal's length by the product of the two
  // longest squared edges. With x and y the squared edges ab and ac, the third one is at most
  // 2 (x + y), so that product is at most 2 (x + y)².
  VDWMESH_HD static bool may_be_small(const Vec3d& ab, const Vec3d& ac, const Vec3d& normal) {
    const double sum = squared_norm(ab) + squared_norm(ac);
    return squared_norm(normal) < 2.001 * kFloorSine * kFloorSine * (sum * sum);
  }
  VDWMESH_HD static bool is_small(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    return !(StarTriangle(a, b, c).least_squared_sine() > kFloorSine * kFloorSine);
  }
  // By how much (rad) the arc of an edge leaves its chord at either end; 0 for an edge inside the
  // patch.
  VDWMESH_HD double bulge(const LinkedTriangle& t, std::size_t edge) const {
    return t.pieces[edge] == kNoPiece ? 0 : boundary_.pieces[t.pieces[edge]].bulge;
  }

  // Chooses pieces to split because of an inward triangle: its own pieces if it has any; else the
  // pieces that end in its vertices; else all pieces of the patch. So at least one piece is always
  // found, and meshing goes on with a finer boundary.
  VDWMESH_HD void split_around(const LinkedTriangle& t) {
    const std::size_t before = found_.size();
    for (const std::uint32_t piece : t.pieces) {
      if (piece != kNoPiece) found_.push_back(piece);
    }
    if (found_.size() > before) return;
    const auto ends_in = [&](std::uint32_t point) {
      return t.vertices[0] == point || t.vertices[1] == point || t.vertices[2] == point;
    };
    for (std::uint32_t p = 0; p < boundary_.pieces.size(); ++p) {
      if (ends_in(boundary_.pieces[p].from) || ends_in(boundary_.pieces[p].to)) found_.push_back(p);
    }
    if (found_.size() > before) return;
    for (std::uint32_t p = 0; p < boundary_.pieces.size(); ++p) found_.push_back(p);
  }

  // Tests whether the arcs of the triangle's pieces would use up one of its angles. At vertex k,
  // the arc of an edge that bulges into the triangle takes its bulge, an angle, from the triangle's
  // angle. If less than kLeastAngleShare of the angle would remain, the pieces that bulge inwards
  // must be split: the halves of a piece have half its bulge.
  VDWMESH_HD void find_folds(const LinkedTriangle& t) {
    if (t.pieces[0] == kNoPiece && t.pieces[1] == kNoPiece && t.pieces[2] == kNoPiece) return;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      // Two arcs that meet in vertex k enclose the angle that the patch has there. It is given, and
      // no split can change it.
      if (t.pieces[k1] != kNoPiece && t.pieces[k2] != kNoPiece) continue;
      const double taken = std::max(0.0, bulge(t, k1)) + std::max(0.0, bulge(t, k2));
      if (taken == 0 || !uses_up(taken, at(t, k), at(t, k1), at(t, k2))) continue;
      for (const std::size_t edge : {k1, k2}) {
        if (bulge(t, edge) > 0) found_.push_back(t.pieces[edge]);
      }
    }
  }

  const PatchBoundaryView& boundary_;
  const PatchTrianglesOf<Memory>& patch_;
  Pieces& found_;
};

}  // namespace smoothing

template <class Memory>
VDWMESH_HD void smooth(const PatchBoundaryView& boundary, const PointCirclesOf<Memory>& circles,
                       int passes, SmoothingScratchOf<Memory>& scratch,
                       PatchTrianglesOf<Memory>& patch) {
  smoothing::Smoother<Memory>(boundary, circles, scratch, patch).run(passes);
}

template <class Memory>
VDWMESH_HD bool find_defects(const PatchBoundaryView& boundary,
                             const PatchTrianglesOf<Memory>& patch,
                             typename Memory::template Array<std::uint32_t>& found) {
  return smoothing::DefectFinder<Memory>(boundary, patch, found).run();
}

}  // namespace vdwmesh
