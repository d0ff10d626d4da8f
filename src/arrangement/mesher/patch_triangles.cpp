#include "arrangement/mesher/patch_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "arrangement/directions.hpp"
#include "core/multiversion.hpp"

namespace vdwmesh {
namespace {

// Of the angle of the flat triangle, what must remain when arcs replace its chords.
constexpr double kLeastRest = 0.3;

constexpr int next(int k) { return k == 2 ? 0 : k + 1; }
constexpr int previous(int k) { return k == 0 ? 2 : k - 1; }

// Whether the triangle, counter-clockwise, faces away from the centre: by differences, which keep
// their digits in small triangles.
bool faces_outwards(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return dot(a, cross(b - a, c - a)) > 0;
}

// Squared sine of the least angle, which is at most 60°.
double least_squared_sine(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a;
  const double x = squared_norm(ab), y = squared_norm(ac), z = squared_norm(c - b);
  const double two_longest = x * y * z / std::min({x, y, z});
  return squared_norm(cross(ab, ac)) / two_longest;
}

// Whether the angles at a and d over the edge bc sum to more than half a turn.
bool exceed_half_turn(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  constexpr double kSlack = 1e-12;  // co-circular points do not flip for ever
  const Vec3d ab = b - a, ac = c - a, db = b - d, dc = c - d;
  const double cosine_a = dot(ab, ac), cosine_d = dot(db, dc);
  if (cosine_a >= 0 && cosine_d >= 0) return false;
  const double sine_a = norm(cross(ab, ac)), sine_d = norm(cross(db, dc));
  // sin(α + δ), times the four lengths.
  return sine_a * cosine_d + cosine_a * sine_d <
         -kSlack * (sine_a + std::abs(cosine_a)) * (sine_d + std::abs(cosine_d));
}

double angle_at(const Vec3d& apex, const Vec3d& a, const Vec3d& b) {
  const Vec3d u = a - apex, v = b - apex;
  return std::atan2(norm(cross(u, v)), dot(u, v));
}

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

  // Squared sine of the least angle of the triangles around vertex v, were it at p; -1 where one
  // turns, and where there is none above `enough`.
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

  // To the mean of its triangles' centroids, weighted by area; or half the way there.
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

  // Flips edge k of triangle t where the angles opposite to it sum to more than half a turn, both
  // new triangles face outwards and the new edge may be one.
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

  std::uint32_t first_interior_;
  const PointCircles& circles_;
  std::vector<Vec3d>& points_;
  std::vector<PatchTriangle>& triangles_;
  std::vector<std::uint32_t> first_, star_;  // triangles around each vertex
};

// Finds the pieces that have to be split because of one triangle after the other.
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
  double bulge(const PatchTriangle& t, std::size_t edge) const {
    return t.pieces[edge] == kNoPiece ? 0 : boundary_.pieces[t.pieces[edge]].bulge;
  }

  // The triangle's own pieces; if it has none, those that end in its vertices; if there are none
  // either, all pieces of the patch.
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

  void find_folds(const PatchTriangle& t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      // Between two arcs there is the angle of the patch's corner, whatever the chords.
      if (t.pieces[k1] != kNoPiece && t.pieces[k2] != kNoPiece) continue;
      const double taken = std::max(0.0, bulge(t, k1)) + std::max(0.0, bulge(t, k2));
      if (taken == 0) continue;
      if (!(taken > (1 - kLeastRest) * angle_at(at(t, k), at(t, k1), at(t, k2)))) continue;
      for (const std::size_t edge : {k1, k2}) {
        if (bulge(t, edge) > 0) found_.push_back(t.pieces[edge]);
      }
    }
  }

  const PatchBoundary& boundary_;
  const PatchTriangles& patch_;
  std::vector<std::uint32_t> found_;
};

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
