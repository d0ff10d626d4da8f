// mesh_saddle(): constrained Delaunay refinement in the conformal plane of a saddle.
//
// Steps: (1) gather the sample points around the saddle, counter-clockwise; a ring goes down one
// side of its seam and up the other; (2) triangulate them with the pieces of the curves as
// constraints; (3) ask for splits of pieces that are long for the width of the saddle; (4) insert
// rows of points; (5) insert circumcentres of bad triangles (Chew); (6) look for triangles that
// face inwards.
//
// A waist gets no points inside: its triangles reach from end to end.
//
// In a cusp the mesh ends in a fan of triangles, whose angles are given by the cusp.
#include "excluded/mesher/saddle_mesher.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "creases/patch/patch_quality.hpp"
#include "creases/plane/flat_boundary.hpp"
#include "creases/plane/inside_marks.hpp"
#include "excluded/mesher/saddle_chart.hpp"

namespace vdwmesh::excluded {
namespace {

using Location = PlaneTriangulation::Location;
using Place = PlaneTriangulation::Place;

// rad about the saddle's axis. No triangle spans more than kWidestTurn; points that follow each
// other in a row are at most kRowTurn apart.
constexpr double kWidestTurn = 0.9, kRowTurn = 0.75;
// The largest edge length as a fraction of the probe's radius.
constexpr double kLongestEdge = 0.8;
// Rows keep this distance from the curves, as a fraction of the edge length.
constexpr double kRowMargin = 0.55;
// As in the mesher of patches: the shortest piece, as a fraction of the edge length, that is split
// for quality.
constexpr double kShortestPiece = 1e-3;
// A place of a saddle that would need pieces shorter than this fraction of the edge length is left
// to few flat triangles.
constexpr double kNarrow = 0.005;
// The longest edge of a triangle at a cusp, as a multiple of the edge length.
constexpr double kLongestAtCusp = 1.6;

PlanePoint circumcenter_of(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
  const double d = 2 * (bx * cy - by * cx), bb = bx * bx + by * by, cc = cx * cx + cy * cy;
  return {a.x + (cy * bb - by * cc) / d, a.y + (bx * cc - cx * bb) / d};
}

class SaddleTriangulator {
 public:
  SaddleTriangulator(const CurveComplex& complex, const ArcSampling& sampling,
                     const SaddleFace& face, const PatchOptions& options, PlaneTriangulation& plane)
      : complex_(complex),
        sampling_(sampling),
        face_(face),
        arc_(complex.grown().surface.arcs[face.arc]),
        chart_(arc_, complex.grown().surface.probe_radius, radial_of(complex, face), face.part),
        options_(options),
        edge_length_(
            std::min(options.edge_length, kLongestEdge * complex.grown().surface.probe_radius)),
        plane_(plane) {}

  SaddleMesh run() && {
    gather();
    if (!insert_boundary()) return requests();
    mark_inside();
    if (!face_.part.waist) find_long_pieces();
    if (!splits_.empty() || options_.stage == PatchStage::boundary) return requests();
    if (!face_.part.waist) {
      insert_rows();
      refine();
    }
    find_defects();
    if (!splits_.empty()) return requests();
    return finish();
  }

 private:
  // A point of the saddle; on the boundary with its place in the sampling.
  struct SaddleVertex {
    TorusPoint torus;
    Vec3d position;
    CurvePoint source;
    std::uint32_t runs;  // the curves around the saddle that it lies on, one bit each
  };
  struct BoundaryEdge {
    ArcPiece source;
    std::uint32_t run;
  };

  // The seam of a ring, or the start of the arc.
  static Vec3d radial_of(const CurveComplex& complex, const SaddleFace& face) {
    const RolledArc& arc = complex.grown().surface.arcs[face.arc];
    return arc.is_ring() ? any_orthogonal(arc.axis) : arc.radial[0];
  }

  SaddleMesh requests() {
    SaddleMesh out;
    out.splits = std::move(splits_);
    return out;
  }
  void want_split(std::uint32_t piece, std::uint32_t halvings = 1) {
    splits_.push_back({pieces_[piece].source, halvings});
  }

  // Lists the boundary counter-clockwise, as runs 0 to 3: along the contact curve of ball a, up the
  // profile at the arc's end, back along the contact curve of ball b, down the profile at the arc's
  // start.
  void gather() {
    if (face_.contact[0] != kNoIndex) add_run(face_.contact[0], false, 0);
    add_run(face_.profile[1], false, 1);
    if (face_.contact[1] != kNoIndex) add_run(face_.contact[1], true, 2);
    add_run(face_.profile[0], true, 3);
    const auto count = static_cast<std::uint32_t>(points_.size());
    for (std::uint32_t i = 0; i < count; ++i) {
      // A point is the end of the piece before it, too.
      points_[i].runs |= 1u << pieces_[(i + count - 1) % count].run;
    }
    boundary_count_ = count;
  }

  // Adds the points of a curve but for its last one, and all pieces. Piece i begins at point i.
  void add_run(std::uint32_t curve, bool backwards, std::uint32_t run) {
    const std::uint32_t n = sampling_.pieces(curve);
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t k = backwards ? n - i : i;
      const double part = sampling_.part(curve, k);
      const bool last = k == n;
      TorusPoint at{};
      if (run % 2 == 0) {
        at = {arc_.angle * part, run == 0 ? chart_.from() : chart_.to()};
      } else {
        const double sweep = chart_.to() - chart_.from();
        at = {run == 1 ? arc_.angle : 0, last ? chart_.to() : chart_.from() + sweep * part};
      }
      if (is_cusp_end(run, k, n)) cusp_ = static_cast<std::uint32_t>(points_.size());
      points_.push_back({at, sampling_.point(curve, k), {curve, k}, 1u << run});
      pieces_.push_back({{curve, backwards ? k - 1 : k}, run});
    }
  }

  // Whether sample point k of a profile curve is the cusp.
  bool is_cusp_end(std::uint32_t run, std::uint32_t k, std::uint32_t n) const {
    return run % 2 == 1 && ((face_.part.half == 0 && k == n) || (face_.part.half == 1 && k == 0));
  }

  std::uint32_t piece_count() const { return boundary_count_; }
  std::uint32_t end_of(std::uint32_t piece) const {
    return piece + 1 == boundary_count_ ? 0 : piece + 1;
  }

  bool insert_boundary() {
    std::vector<PlanePoint> images;
    for (const SaddleVertex& p : points_) images.push_back(chart_.project(p.torus));
    plane_.start(images, nullptr);
    std::uint32_t near = 0;
    for (const std::uint32_t i : boundary_order(boundary_count_)) {
      check_cancelled(options_.monitor, i);
      const Location at = plane_.locate(images[i], near);
      if (at.place == Place::on_vertex) throw CoincidentPoints();
      plane_.insert(i, at);
      near = plane_.triangle_at(i);
    }
    for (std::uint32_t p = 0; p < piece_count(); ++p) {
      const auto outcome = plane_.insert_piece(p, end_of(p), p);
      if (outcome != PlaneTriangulation::Outcome::inserted) want_split(p);
    }
    return splits_.empty();
  }

  bool is_left_of_piece(std::uint32_t t, std::uint32_t k) const {
    const LinkedTriangle& w = plane_.triangle(t);
    return w.pieces[k] != kNoPiece && w.pieces[k] == w.vertices[corner_after(k)];
  }

  void mark_inside() {
    std::vector<std::uint32_t> stack;
    for (std::uint32_t t = 0; t < plane_.triangles().size(); ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        if (is_left_of_piece(t, k)) mark_and_list(plane_, t, stack);
      }
    }
    mark_reachable(plane_, stack);
  }

  void find_long_pieces() {
    if (options_.demand == Demand::validity) return;
    visit_marked(plane_, [&](std::uint32_t t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        if (plane_.triangle(t).pieces[k] != kNoPiece) judge_piece(plane_.triangle(t), k);
      }
    });
  }

  const Vec3d& position(const LinkedTriangle& t, std::uint32_t k) const {
    return points_[t.vertices[k]].position;
  }

  // As in the mesher of patches: a vertex on the piece's own curve says nothing about the width,
  // and of two pieces that meet in a corner only the ratio of lengths counts.
  void judge_piece(const LinkedTriangle& t, std::uint32_t k) {
    const std::uint32_t k1 = corner_after(k), k2 = corner_before(k), piece = t.pieces[k];
    const Vec3d &a = position(t, k1), &b = position(t, k2), &p = position(t, k);
    const double length = norm(b - a);
    if (length <= kShortestPiece * edge_length_) return;
    for (const std::uint32_t other : {k1, k2}) {
      if (t.pieces[other] == kNoPiece) continue;
      const double beside = other == k1 ? norm(p - b) : norm(p - a);
      if (length > kCornerRatio * beside) want_split(piece);
      return;
    }
    if ((points_[t.vertices[k]].runs & runs_beside(pieces_[piece].run)) != 0) return;
    const double height = norm(cross(b - a, p - a)) / length;
    if (height < kNarrow * kLocalWidth * edge_length_) return;
    if (const std::uint32_t halvings = halvings_for_width(a, b, p)) want_split(piece, halvings);
  }

  // The curves, one bit each, that say nothing about the width at a piece: its own; and the other
  // side of a seam, which is the same curve.
  std::uint32_t runs_beside(std::uint32_t run) const {
    constexpr std::uint32_t kProfiles = 1u << 1 | 1u << 3;
    return run % 2 == 1 && arc_.is_ring() ? kProfiles : 1u << run;
  }

  bool is_free(const Location& at) const {
    return (at.place == Place::inside || at.place == Place::on_edge) && !plane_.is_on_piece(at) &&
           plane_.is_inside(at.triangle);
  }

  std::uint32_t insert_interior(const TorusPoint& torus, const PlanePoint& p, const Location& at) {
    const std::uint32_t vertex = plane_.add_point(p);
    points_.push_back({torus, chart_.point(torus), {kNoIndex, 0}, 0});
    plane_.insert(vertex, at);
    return vertex;
  }

  // Rows of points along the arc. Points of neighbouring rows are shifted by half their distance.
  void insert_rows() {
    const double p = complex_.grown().surface.probe_radius, h = edge_length_;
    const double length = p * (chart_.to() - chart_.from());
    const auto rows = static_cast<int>(std::lround(length / (std::sqrt(0.75) * h)));
    std::uint32_t near = plane_.triangle_at(0);
    for (int i = 1; i < rows; ++i) {
      const double share = static_cast<double>(i) / rows;
      if (std::min(share, 1 - share) * length < kRowMargin * h) continue;
      const double profile = chart_.from() + share * (chart_.to() - chart_.from());
      const double width = chart_.girth(profile) * arc_.angle;
      const double count = std::max(1.0, std::ceil(std::max(width / h, arc_.angle / kRowTurn)));
      for (double j = i % 2 == 0 ? 0 : 0.5; j < count; ++j) {
        if (std::min(j, count - j) / count * width < kRowMargin * h) continue;
        insert_row_point({j / count * arc_.angle, profile}, near);
      }
    }
  }

  void insert_row_point(const TorusPoint& torus, std::uint32_t& near) {
    const PlanePoint p = chart_.project(torus);
    const Location at = plane_.locate(p, near);
    near = at.triangle;
    if (is_free(at)) near = plane_.triangle_at(insert_interior(torus, p, at));
  }

  struct Candidate {
    std::uint32_t triangle;
    std::array<std::uint32_t, 3> vertices;
  };

  // The corners of a triangle that have the least and the largest turn about the axis, and how far
  // they are from each other. A cusp has no turn.
  struct Turn {
    std::uint32_t from, to;
    double angle;
  };
  Turn turn_of(const std::array<std::uint32_t, 3>& vertices) const {
    Turn turn{kNoIndex, kNoIndex, 0};
    const auto at = [&](std::uint32_t v) { return points_[v].torus.turn; };
    for (const std::uint32_t v : vertices) {
      if (v == cusp_) continue;
      if (turn.from == kNoIndex || at(v) < at(turn.from)) turn.from = v;
      if (turn.to == kNoIndex || at(v) > at(turn.to)) turn.to = v;
    }
    turn.angle = at(turn.to) - at(turn.from);
    return turn;
  }

  bool is_bad_triangle(std::uint32_t t) const {
    const LinkedTriangle& w = plane_.triangle(t);
    if (turn_of(w.vertices).angle > kWidestTurn) return true;
    const std::array<Vec3d, 3> p{position(w, 0), position(w, 1), position(w, 2)};
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (w.vertices[k] == cusp_) return is_large_at_cusp(w, p, k);
    }
    return is_bad(p, {w.pieces[0] != kNoPiece, w.pieces[1] != kNoPiece, w.pieces[2] != kNoPiece},
                  edge_length_);
  }

  bool is_large_at_cusp(const LinkedTriangle& w, const std::array<Vec3d, 3>& p,
                        std::uint32_t k) const {
    const std::uint32_t k1 = corner_after(k), k2 = corner_before(k);
    if (w.pieces[k1] != kNoPiece && w.pieces[k2] != kNoPiece) return false;
    const double longest = kLongestAtCusp * edge_length_;
    return std::max(squared_norm(p[k1] - p[k]), squared_norm(p[k2] - p[k])) > longest * longest;
  }

  bool has_cusp(const std::array<std::uint32_t, 3>& vertices) const {
    return std::find(vertices.begin(), vertices.end(), cusp_) != vertices.end();
  }

  // No point is inserted in the fan around a cusp to mend a triangle beside the fan. The angles of
  // the fan are given, and such points would come ever closer to the cusp.
  void refine() {
    std::vector<Candidate> queue;
    const auto queue_if_bad = [&](std::uint32_t t) {
      if (is_bad_triangle(t)) queue.push_back({t, plane_.triangle(t).vertices});
    };
    visit_marked(plane_, queue_if_bad);
    const std::size_t most = 20 * (points_.size() + 50);
    for (std::size_t i = 0; i < queue.size() && points_.size() < most; ++i) {
      check_cancelled(options_.monitor, i);
      const auto [t, v] = queue[i];
      if (plane_.triangle(t).vertices != v) continue;
      if (const Turn turn = turn_of(v); turn.angle > kWidestTurn) {
        insert_between(turn, t, queue_if_bad);
      } else {
        insert_circumcenter(v, t, queue_if_bad);
      }
    }
  }

  // Inserts a point in the middle of a triangle's turn, even if a curve is near.
  template <class Visit>
  void insert_between(const Turn& turn, std::uint32_t t, const Visit& queue_if_bad) {
    const TorusPoint &a = points_[turn.from].torus, &b = points_[turn.to].torus;
    const TorusPoint torus{(a.turn + b.turn) / 2, (a.profile + b.profile) / 2};
    const PlanePoint p = chart_.project(torus);
    const Location at = plane_.locate(p, t);
    if (is_free(at)) plane_.visit_star(insert_interior(torus, p, at), queue_if_bad);
  }

  template <class Visit>
  void insert_circumcenter(const std::array<std::uint32_t, 3>& v, std::uint32_t t,
                           const Visit& queue_if_bad) {
    const PlanePoint p =
        circumcenter_of(plane_.point(v[0]), plane_.point(v[1]), plane_.point(v[2]));
    const Location at = plane_.locate(p, t);
    if (!is_free(at)) return;
    if (has_cusp(plane_.triangle(at.triangle).vertices) && !has_cusp(v)) return;
    const TorusPoint torus = chart_.lift(p);
    if (encroaches(chart_.point(torus), p, at)) return;
    plane_.visit_star(insert_interior(torus, p, at), queue_if_bad);
  }

  bool encroaches(const Vec3d& u, const PlanePoint& p, const Location& at) {
    for (const auto& [t, k] : plane_.pieces_around(p, at.triangle)) {
      const LinkedTriangle& w = plane_.triangle(t);
      const Vec3d a = position(w, corner_after(k)) - u, b = position(w, corner_before(k)) - u;
      if (dot(a, b) < options_.widest_view * std::sqrt(squared_norm(a) * squared_norm(b)))
        return true;
    }
    return false;
  }

  // If a triangle faces inwards at one of its vertices, asks to split the pieces among its edges,
  // or all pieces if there are none.
  void find_defects() {
    visit_marked(plane_, [&](std::uint32_t t) {
      const LinkedTriangle& w = plane_.triangle(t);
      const Vec3d normal = cross(position(w, 1) - position(w, 0), position(w, 2) - position(w, 0));
      const bool sound = std::all_of(w.vertices.begin(), w.vertices.end(), [&](std::uint32_t v) {
        return v == cusp_ || dot(normal, chart_.normal(points_[v].torus)) > 0;
      });
      if (sound) return;
      const std::size_t before = splits_.size();
      for (const std::uint32_t piece : w.pieces) {
        if (piece != kNoPiece && may_split(piece)) want_split(piece);
      }
      if (splits_.size() > before) return;
      for (std::uint32_t p = 0; p < piece_count(); ++p) {
        if (may_split(p)) want_split(p);
      }
    });
  }
  // The sides of a waist would get points on the axis.
  bool may_split(std::uint32_t piece) const {
    return !face_.part.waist || pieces_[piece].run % 2 == 0;
  }

  SaddleMesh finish() {
    SaddleMesh out;
    for (std::uint32_t i = 0; i < boundary_count_; ++i) out.boundary.push_back(points_[i].source);
    for (std::size_t i = boundary_count_; i < points_.size(); ++i) {
      out.interior.push_back(points_[i].position);
      out.normals.push_back(chart_.normal(points_[i].torus));
    }
    visit_marked(plane_,
                 [&](std::uint32_t t) { out.triangles.push_back(plane_.triangle(t).vertices); });
    return out;
  }

  const CurveComplex& complex_;
  const ArcSampling& sampling_;
  const SaddleFace& face_;
  const RolledArc& arc_;
  const SaddleChart chart_;
  const PatchOptions& options_;
  const double edge_length_;  // scaled
  PlaneTriangulation& plane_;
  std::vector<SaddleVertex> points_;  // first those of the boundary, counter-clockwise
  std::vector<BoundaryEdge> pieces_;
  std::uint32_t boundary_count_ = 0;
  std::uint32_t cusp_ = kNoIndex;  // the point of the cusp, if there is one
  PatchVector<PieceSplit> splits_;
};

}  // namespace

SaddleMesh mesh_saddle(const CurveComplex& complex, const ArcSampling& sampling,
                       const SaddleFace& face, const PatchOptions& options,
                       PlaneTriangulation& plane) {
  return SaddleTriangulator(complex, sampling, face, options, plane).run();
}

}  // namespace vdwmesh::excluded
