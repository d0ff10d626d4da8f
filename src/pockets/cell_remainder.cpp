// cell_remainder(): a tetrahedron is cut into its parts in the balls' power cells. In such a part,
// the union is that cell's ball alone. With h the signed height of a face's plane over the ball's
// centre, positive if the centre is on the inner side,
//   area of the sphere in the part = R² × sum over faces of the solid angle outside the ball
//   volume of ball ∩ part          = R area / 3 + sum over faces of h × area of face ∩ ball / 3
#include "pockets/cell_remainder.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "complex/simplex_shape.hpp"
#include "core/errors.hpp"
#include "core/sum.hpp"
#include "pockets/disc_pieces.hpp"

namespace vdwmesh {
namespace {

// Only coordinates that are not finite leave a face open.
constexpr const char* kNotFinite =
    "the spheres' sizes and distances differ by too many powers of ten to cut tetrahedra in double "
    "precision";

// A face of a convex polyhedron. Its edges stand in no order, each counter-clockwise seen from
// outside. `beyond`: the ball whose power cell is there, or for the first four faces kNoIndex.
struct CutFace {
  Vec3d normal;  // unit, outward
  std::uint32_t beyond;
};

struct CutEdge {
  std::uint32_t face;
  Vec3d from, to;
};

struct CutPolyhedron {
  std::vector<CutFace> faces;
  std::vector<CutEdge> edges;
};

Vec3d unit(const Vec3d& v) { return 1 / norm(v) * v; }

// Cuts off what lies beyond the plane: where dot(normal, x) > offset. An edge that crosses the
// plane does so in one point for both its faces, so every face stays closed.
class PlaneCut {
 public:
  void apply(CutPolyhedron& solid, const Vec3d& normal, double offset, std::uint32_t beyond) {
    const auto value = [&](const Vec3d& x) { return dot(normal, x) - offset; };
    const bool is_cut = std::any_of(solid.edges.begin(), solid.edges.end(),
                                    [&](const CutEdge& e) { return value(e.from) > 0; });
    if (!is_cut) return;
    kept_.clear(), entries_.clear(), exits_.clear();
    for (const CutEdge& e : solid.edges) {
      const double at_from = value(e.from), at_to = value(e.to);
      if (at_from <= 0 && at_to <= 0) {
        kept_.push_back(e);
      } else if (at_from <= 0) {
        const Vec3d x = crossing(e.from, e.to, at_from, at_to);
        kept_.push_back({e.face, e.from, x});
        exits_.push_back({e.face, x});
      } else if (at_to <= 0) {
        const Vec3d x = crossing(e.to, e.from, at_to, at_from);
        kept_.push_back({e.face, x, e.to});
        entries_.push_back({e.face, x});
      }
    }
    close(static_cast<std::uint32_t>(solid.faces.size()));
    solid.edges.swap(kept_);
    solid.faces.push_back({unit(normal), beyond});
  }

 private:
  struct CutPoint {
    std::uint32_t face;
    Vec3d point;
  };

  // From the inner end, whichever way the edge runs.
  static Vec3d crossing(const Vec3d& inner, const Vec3d& outer, double at_inner, double at_outer) {
    return inner + at_inner / (at_inner - at_outer) * (outer - inner);
  }

  // Closes each face that was cut by an edge in the plane, which the new face has the other way
  // round. A face has as many exits as entries: one, if rounding did not bend it.
  void close(std::uint32_t new_face) {
    for (const CutPoint& exit : exits_) {
      const auto entry = std::find_if(entries_.begin(), entries_.end(),
                                      [&](const CutPoint& c) { return c.face == exit.face; });
      if (entry == entries_.end()) throw InvalidInput(kNotFinite);
      kept_.push_back({exit.face, exit.point, entry->point});
      kept_.push_back({new_face, entry->point, exit.point});
      *entry = entries_.back();
      entries_.pop_back();
    }
  }

  std::vector<CutEdge> kept_;
  std::vector<CutPoint> entries_, exits_;
};

class RemainderFinder {
 public:
  RemainderFinder(const PowerTriangulation& t, const BallNeighbors& neighbors, std::uint32_t cell)
      : t_(t), neighbors_(neighbors), vertices_(t.cells[cell]), origin_(ball(vertices_[0]).center) {
    for (std::size_t k = 0; k < 4; ++k) {
      const auto& f = kFacetVertices[k];
      // kFacetVertices is counter-clockwise seen from inside.
      const std::array<Vec3d, 3> v{place(vertices_[f[0]]), place(vertices_[f[2]]),
                                   place(vertices_[f[1]])};
      const Vec3d normal = cross(v[1] - v[0], v[2] - v[0]);
      tetrahedron_.faces.push_back({unit(normal), kNoIndex});
      out_.face_area[k] = norm(normal) / 2;
      for (std::uint32_t i = 0; i < 3; ++i) {
        tetrahedron_.edges.push_back({static_cast<std::uint32_t>(k), v[i], v[(i + 1) % 3]});
      }
    }
  }

  // Goes from power cell to power cell, across the faces that the parts have with each other.
  CellRemainder run() && {
    const Sphere& a = ball(vertices_[0]);
    volume_.add(
        tetrahedron_shape({a, ball(vertices_[1]), ball(vertices_[2]), ball(vertices_[3])}).volume);
    seen_ = {nearest_to_middle()};
    for (std::size_t next = 0; next < seen_.size(); ++next) {
      const std::uint32_t i = seen_[next];
      cut_to_power_cell(i);
      if (!part_.edges.empty()) subtract_ball(i);
    }
    out_.volume = volume_.value();
    out_.area = area_.value();
    return std::move(out_);
  }

 private:
  const Sphere& ball(std::uint32_t i) const { return t_.balls[i]; }
  Vec3d place(std::uint32_t i) const { return ball(i).center - origin_; }

  double power(std::uint32_t i, const Vec3d& x) const {
    const double r = ball(i).radius;
    return squared_norm(x - place(i)) - r * r;
  }

  // The ball with the least power at the tetrahedron's centroid: in a regular triangulation, a ball
  // none of whose neighbours has less.
  std::uint32_t nearest_to_middle() const {
    Vec3d middle{};
    for (const std::uint32_t v : vertices_) middle = middle + 0.25 * place(v);
    std::uint32_t best = vertices_[0];
    double least = power(best, middle);
    for (std::uint32_t from = kNoIndex; from != best;) {
      from = best;
      for (const std::uint32_t n : neighbors_[from]) {
        const double at_n = power(n, middle);
        if (at_n < least) least = at_n, best = n;
      }
    }
    return best;
  }

  void cut_to_power_cell(std::uint32_t i) {
    part_ = tetrahedron_;
    std::uint32_t last = kNoIndex;
    for (const std::uint32_t n : neighbors_[i]) {
      if (part_.edges.empty()) return;
      if (n == last) continue;
      last = n;
      const Vec3d between = ball(n).center - ball(i).center;
      const double squared_length = squared_norm(between);
      const double r = ball(i).radius, s = ball(n).radius;
      const double foot = (squared_length + (r - s) * (r + s)) / 2;
      cut_.apply(part_, between, dot(between, place(i)) + foot, n);
    }
  }

  void subtract_ball(std::uint32_t i) {
    const Vec3d center = place(i);
    const double radius = ball(i).radius;
    pieces_.assign(part_.faces.size(), DiscPieces{});
    heights_.assign(part_.faces.size(), std::nan(""));
    for (const CutEdge& e : part_.edges) {
      const Vec3d& normal = part_.faces[e.face].normal;
      // Where the face's first edge begins is where its plane is.
      double& height = heights_[e.face];
      if (std::isnan(height)) {
        height = height_of(i, e);
        reach(part_.faces[e.face].beyond);
      }
      const Vec3d foot = center + height * normal;
      add_edge_pieces(pieces_[e.face], e.from - foot, e.to - foot, normal, height, radius);
    }
    double solid_angle = 0, cones = 0;
    for (std::size_t f = 0; f < pieces_.size(); ++f) {
      if (std::isnan(heights_[f])) continue;
      solid_angle += pieces_[f].solid_angle;
      cones += heights_[f] * pieces_[f].area / 3;
      if (f >= 4) continue;
      out_.face_area[f] -= pieces_[f].area;
      const double squared_disc = (radius - heights_[f]) * (radius + heights_[f]);
      if (squared_disc > 0) out_.face_rim[f] += std::sqrt(squared_disc) * pieces_[f].angle;
    }
    const double area = radius * radius * solid_angle;
    area_.add(area);
    volume_.add(-radius * area / 3 - cones);
    out_.ball_area.push_back({i, area});
  }

  double height_of(std::uint32_t i, const CutEdge& e) const {
    const CutFace& face = part_.faces[e.face];
    if (face.beyond == kNoIndex) {
      // A face with the ball's own centre is at height 0 exactly.
      for (std::size_t k = 0; k < 4; ++k) {
        if (vertices_[k] == i && k != e.face) return 0;
      }
      return dot(face.normal, tetrahedron_.edges[3 * e.face].from - place(i));
    }
    return edge_shape(ball(i), ball(face.beyond)).height[0];
  }

  void reach(std::uint32_t i) {
    if (i != kNoIndex && std::find(seen_.begin(), seen_.end(), i) == seen_.end())
      seen_.push_back(i);
  }

  const PowerTriangulation& t_;
  const BallNeighbors& neighbors_;
  const std::array<std::uint32_t, 4> vertices_;
  const Vec3d origin_;
  CutPolyhedron tetrahedron_, part_;  // relative to origin_
  PlaneCut cut_;
  std::vector<std::uint32_t> seen_;  // balls, in the order in which they were reached
  std::vector<DiscPieces> pieces_;   // per face of part_
  std::vector<double> heights_;      // per face of part_; NaN: it has no edges
  WideSum volume_, area_;
  CellRemainder out_;
};

}  // namespace

BallNeighbors ball_neighbors(const PowerTriangulation& t) {
  BallNeighbors rows;
  rows.fill(t.balls.size(), t.cells.size(), [&](std::size_t c, const auto& add) {
    for (const auto& pair : kPairs) {
      const std::uint32_t i = t.cells[c][pair[0]], j = t.cells[c][pair[1]];
      if (!t.is_ball(i) || !t.is_ball(j)) continue;
      add(i, j);
      add(j, i);
    }
  });
  return rows;
}

CellRemainder cell_remainder(const PowerTriangulation& triangulation,
                             const BallNeighbors& neighbors, std::uint32_t cell) {
  return RemainderFinder(triangulation, neighbors, cell).run();
}

}  // namespace vdwmesh
