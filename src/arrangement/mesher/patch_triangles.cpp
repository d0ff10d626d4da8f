// Smooths the triangles of a patch, and finds the pieces that make triangles invalid.
//
// Smoothing is Laplacian with a quality test ("smart"): a point moves towards the centroid of its
// triangles only if the least angle around it grows. Edges are flipped by the local Delaunay
// criterion on the flat triangles: the two angles opposite to an edge must not add up to more than
// half a turn. patch_mesher.cpp calls smooth() and then defects() at the end of meshing one patch.
#include "arrangement/mesher/patch_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "arrangement/directions.hpp"
#include "core/multiversion.hpp"

namespace vdwmesh {
namespace {

// The fraction of a flat triangle's angle that must remain when arcs replace the chords beside it.
constexpr double kLeastAngleShare = 0.3;

// The index that follows or precedes k counter-clockwise among the corners of a triangle.
constexpr int next(int k) { return k == 2 ? 0 : k + 1; }
constexpr int previous(int k) { return k == 0 ? 2 : k - 1; }

// Whether the triangle a, b, c is counter-clockwise seen from outside, so that its normal points
// away from the sphere's centre. The sign of a · (b × c) says the same, but it cancels for small
// triangles; differences of nearby points keep their digits.
bool faces_outwards(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return dot(a, cross(b - a, c - a)) > 0;
}

// Squared sine of the least angle of a triangle. The least angle is at most 60°, so comparing sines
// compares angles. It lies between the two longest edges, and its sine is twice the area divided by
// the product of their lengths.
double least_squared_sine(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a;
  const double x = squared_norm(ab), y = squared_norm(ac), z = squared_norm(c - b);
  const double two_longest = x * y * z / std::min({x, y, z});
  return squared_norm(cross(ab, ac)) / two_longest;
}

// Whether the angles at a and d, opposite to the common edge bc, add up to more than half a turn.
// Then the edge is not locally Delaunay. For angles α and δ of two triangles, this holds if and
// only if sin(α + δ) < 0, because each is less than half a turn.
bool exceed_half_turn(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  // Relative. Without it, rounding could flip the edge of four co-circular points to and fro for
  // ever.
  constexpr double kSlack = 1e-12;
  const Vec3d ab = b - a, ac = c - a, db = b - d, dc = c - d;
  const double cosine_a = dot(ab, ac), cosine_d = dot(db, dc);
  // Both angles are at most a right angle, so their sum is at most half a turn.
  if (cosine_a >= 0 && cosine_d >= 0) return false;
  const double sine_a = norm(cross(ab, ac)), sine_d = norm(cross(db, dc));
  // sin(α + δ), times the lengths of the four outer edges.
  return sine_a * cosine_d + cosine_a * sine_d <
         -kSlack * (sine_a + std::abs(cosine_a)) * (sine_d + std::abs(cosine_d));
}

// The angle (rad) at `apex` between the directions to a and b.
double angle_at(const Vec3d& apex, const Vec3d& a, const Vec3d& b) {
  const Vec3d u = a - apex, v = b - apex;
  return std::atan2(norm(cross(u, v)), dot(u, v));
}

// Smooths in place; see smooth() in the header.
class Smoother {
 public:
  Smoother(const PatchBoundary& boundary, const PointCircles& circles, PatchTriangles& patch)
      : first_interior_(static_cast<std::uint32_t>(boundary.points.size())),
        circles_(circles),
        points_(patch.points),
        triangles_(patch.triangles) {}

  void run(int passes) {
    make_delaunay();
    for (int pass = 0; pass < passes; ++pass) {
      index_stars();
      for (std::uint32_t v = first_interior_; v < points_.size(); ++v) move(v);
      make_delaunay();
    }
  }

 private:
  // Lists the triangles around each vertex, its star, as compressed sparse rows. Flips change the
  // stars, so they are listed anew in each pass.
  void index_stars() {
    first_.assign(points_.size() + 1, 0);
    for (const PatchTriangle& t : triangles_) {
      for (const std::uint32_t v : t.vertices) ++first_[v + 1];
    }
    for (std::size_t v = 0; v < points_.size(); ++v) first_[v + 1] += first_[v];
    star_.resize(first_.back());
    std::vector<std::uint32_t> place(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (const std::uint32_t v : triangles_[t].vertices) star_[place[v]++] = t;
    }
  }

  // The squared sine of the least angle of the triangles around vertex v if v were at p. Returns -1
  // if a triangle would face inwards, or if the squared sine would not be larger than `enough`. A
  // value of -1 for `enough` demands nothing.
  double least_angle_around(std::uint32_t v, const Vec3d& p, double enough) const {
    double least = 1;
    for (std::uint32_t i = first_[v]; i < first_[v + 1]; ++i) {
      const auto& w = triangles_[star_[i]].vertices;
      const std::size_t k = w[0] == v ? 0 : (w[1] == v ? 1 : 2);
      const Vec3d &a = points_[w[(k + 1) % 3]], &b = points_[w[(k + 2) % 3]];
      if (!faces_outwards(p, a, b)) return -1;
      least = std::min(least, least_squared_sine(p, a, b));
      if (!(least > enough)) return -1;
    }
    return least;
  }

  // Moves vertex v to the mean of the centroids of its triangles, weighted by area and scaled to
  // the sphere. If that does not enlarge the least angle, the middle between the old and the new
  // position is tried; if that fails too, v stays.
  void move(std::uint32_t v) {
    Vec3d sum{0, 0, 0};
    for (std::uint32_t i = first_[v]; i < first_[v + 1]; ++i) {
      const auto& w = triangles_[star_[i]].vertices;
      const Vec3d &a = points_[w[0]], &b = points_[w[1]], &c = points_[w[2]];
      sum = sum + norm(cross(b - a, c - a)) * (a + b + c);
    }
    if (!(squared_norm(sum) > 0)) return;
    const double now = least_angle_around(v, points_[v], -1);
    Vec3d p = unit(sum);
    if (least_angle_around(v, p, now) < 0) {
      p = unit(p + points_[v]);
      if (least_angle_around(v, p, now) < 0) return;
    }
    points_[v] = p;
  }

  // Flips an edge of triangle t if it is not locally Delaunay, both new triangles face outwards,
  // and the new edge does not join two points of one circle. Returns whether the edge was flipped.
  //
  // Vertices of triangle t have the indices k, k1, k2: k is opposite to the edge, and k1 and k2
  // follow it counter-clockwise. The indices m, m1, m2 in the neighbouring triangle mean the same.
  bool flip_if_better(std::uint32_t t, int edge) {
    const auto k = static_cast<std::size_t>(edge), k1 = static_cast<std::size_t>(next(edge)),
               k2 = static_cast<std::size_t>(previous(edge));
    PatchTriangle& one = triangles_[t];
    const std::uint32_t n = one.neighbors[k];
    if (n == kNoNeighbor) return false;
    PatchTriangle& two = triangles_[n];
    const auto apart = std::find_if(two.vertices.begin(), two.vertices.end(), [&](std::uint32_t v) {
      return v != one.vertices[k1] && v != one.vertices[k2];
    });
    const auto m = static_cast<std::size_t>(apart - two.vertices.begin()), m1 = (m + 1) % 3,
               m2 = (m + 2) % 3;
    const std::uint32_t a = one.vertices[k], b = one.vertices[k1], c = one.vertices[k2],
                        d = two.vertices[m];
    const Vec3d &pa = points_[a], &pb = points_[b], &pc = points_[c], &pd = points_[d];
    if (!exceed_half_turn(pa, pb, pc, pd)) return false;
    if (!faces_outwards(pa, pb, pd) || !faces_outwards(pa, pd, pc)) return false;
    if (circles_.share(a, d)) return false;
    // Triangles (a, b, c) and (d, c, b) become (a, b, d) and (a, d, c).
    const PatchTriangle old1 = one, old2 = two;
    one = {{a, b, d},
           {old2.neighbors[m1], n, old1.neighbors[k2]},
           {old2.pieces[m1], kNoPiece, old1.pieces[k2]}};
    two = {{a, d, c},
           {old2.neighbors[m2], old1.neighbors[k1], t},
           {old2.pieces[m2], old1.pieces[k1], kNoPiece}};
    // Two of the four outer edges now belong to the other triangle, so the triangles beyond them
    // must point to it.
    const auto relink = [&](std::uint32_t of, std::uint32_t from, std::uint32_t to) {
      if (of == kNoNeighbor) return;
      for (std::uint32_t& link : triangles_[of].neighbors) {
        if (link == from) {
          link = to;
          return;
        }
      }
    };
    relink(old2.neighbors[m1], n, t);
    relink(old1.neighbors[k1], t, n);
    return true;
  }

  // Flips edges in sweeps over all triangles until nothing changes. In one plane flips are sure to
  // come to an end; these triangles do not lie in one plane, so the number of sweeps is limited.
  // The sweeps may stop at any time, because each flip leaves two triangles that face outwards.
  void make_delaunay() {
    constexpr int kMostSweeps = 16;
    bool flipped = true;
    for (int sweep = 0; flipped && sweep < kMostSweeps; ++sweep) {
      flipped = false;
      for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
        for (int k = 0; k < 3; ++k) flipped = flip_if_better(t, k) || flipped;
      }
    }
  }

  // Points from this number on may move.
  std::uint32_t first_interior_;
  const PointCircles& circles_;
  std::vector<Vec3d>& points_;
  std::vector<PatchTriangle>& triangles_;
  // Triangles around vertex v: star_[first_[v]] .. star_[first_[v + 1] - 1].
  std::vector<std::uint32_t> first_, star_;
};

// Collects the pieces to split, triangle by triangle; see defects() in the header.
class DefectFinder {
 public:
  DefectFinder(const PatchBoundary& boundary, const PatchTriangles& patch)
      : boundary_(boundary), patch_(patch) {}

  std::vector<std::uint32_t> run() && {
    for (const PatchTriangle& t : patch_.triangles) {
      if (is_inward(t)) {
        split_around(t);
      } else {
        find_folds(t);
      }
    }
    std::sort(found_.begin(), found_.end());
    found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
    return std::move(found_);
  }

 private:
  const Vec3d& at(const PatchTriangle& t, std::size_t k) const {
    return patch_.points[t.vertices[k]];
  }
  bool is_inward(const PatchTriangle& t) const {
    return !faces_outwards(at(t, 0), at(t, 1), at(t, 2));
  }
  // By how much (rad) the arc of an edge leaves its chord at either end; 0 for an edge inside the
  // patch.
  double bulge(const PatchTriangle& t, std::size_t edge) const {
    return t.pieces[edge] == kNoPiece ? 0 : boundary_.pieces[t.pieces[edge]].bulge;
  }

  // Chooses pieces to split because of an inward triangle: its own pieces if it has any; else the
  // pieces that end in its vertices; else all pieces of the patch. So at least one piece is always
  // found, and meshing goes on with a finer boundary.
  void split_around(const PatchTriangle& t) {
    const std::size_t before = found_.size();
    std::copy_if(t.pieces.begin(), t.pieces.end(), std::back_inserter(found_),
                 [](std::uint32_t piece) { return piece != kNoPiece; });
    if (found_.size() > before) return;
    const auto ends_in = [&](std::uint32_t point) {
      return std::find(t.vertices.begin(), t.vertices.end(), point) != t.vertices.end();
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
  void find_folds(const PatchTriangle& t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      // Two arcs that meet in vertex k enclose the angle that the patch has there. It is given, and
      // no split can change it.
      if (t.pieces[k1] != kNoPiece && t.pieces[k2] != kNoPiece) continue;
      const double taken = std::max(0.0, bulge(t, k1)) + std::max(0.0, bulge(t, k2));
      if (taken == 0) continue;
      if (!(taken > (1 - kLeastAngleShare) * angle_at(at(t, k), at(t, k1), at(t, k2)))) continue;
      for (const std::size_t edge : {k1, k2}) {
        if (bulge(t, edge) > 0) found_.push_back(t.pieces[edge]);
      }
    }
  }

  const PatchBoundary& boundary_;
  const PatchTriangles& patch_;
  std::vector<std::uint32_t> found_;
};

// The whole smoothing is compiled in two versions (core/multiversion.hpp).
VDWMESH_MULTIVERSION void run(Smoother& smoother, int passes) { smoother.run(passes); }

}  // namespace

void smooth(const PatchBoundary& boundary, const PointCircles& circles, int passes,
            PatchTriangles& patch) {
  Smoother smoother(boundary, circles, patch);
  run(smoother, passes);
}

std::vector<std::uint32_t> defects(const PatchBoundary& boundary, const PatchTriangles& patch) {
  return DefectFinder(boundary, patch).run();
}

}  // namespace vdwmesh
