#include "arrangement/mesher/patch_mesher.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "arrangement/directions.hpp"
#include "arrangement/mesher/flat_boundary.hpp"
#include "arrangement/mesher/patch_quality.hpp"
#include "arrangement/mesher/patch_triangles.hpp"
#include "arrangement/mesher/stereographic.hpp"

namespace vdwmesh {
namespace {

using Kernel = FlatBoundary::Kernel;
struct FaceInfo {
  bool inside = false;
  std::uint32_t number = 0;
};
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<FaceInfo, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Planar = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
    CGAL::No_constraint_intersection_tag>;
using Point = Kernel::Point_2;
using VertexHandle = Planar::Vertex_handle;
using FaceHandle = Planar::Face_handle;

constexpr double kPi = std::numbers::pi;

// Interior points of the first lattice keep this much of the edge length from the arcs.
constexpr double kLatticeMargin = 0.55;
// An inserted point may see a piece under an angle of this cosine at most.
constexpr double kWidestView = -0.35;
constexpr int kSmoothingPasses = 1;
// By the radius; without points inside, the triangles of a patch larger than half a sphere face
// inwards.
constexpr double kLongestEdge = 1;

class PlanarPatch {
 public:
  PlanarPatch(const PatchBoundary& boundary, const PatchOptions& options)
      : b_(boundary),
        h_(std::min(options.edge_length, kLongestEdge)),
        options_(options),
        plane_(buried_pole(boundary)),
        flat_(boundary, plane_),
        circles_(boundary),
        points_(boundary.points) {
    planar_.infinite_vertex()->info() = kNoNeighbor;
  }

  PatchMesh run() && {
    if (insert_boundary() && mark_inside()) find_crowded();
    if (!splits_.empty() || options_.stage == PatchStage::boundary) return requests();
    insert_lattice();
    mark_inside();
    refine();
    separate_circles();
    if (!splits_.empty()) return requests();
    PatchTriangles patch{std::move(points_), numbered_triangles()};
    smooth(b_, circles_, kSmoothingPasses, patch);
    for (const std::uint32_t piece : defects(b_, patch)) want_split(piece);
    if (!splits_.empty()) return requests();
    return finish(patch);
  }

 private:
  void want_split(std::uint32_t piece, std::uint32_t halvings = 1) {
    splits_.push_back({b_.pieces[piece].source, halvings});
  }

  // The most halvings that any reason gave.
  PatchMesh requests() {
    std::sort(splits_.begin(), splits_.end(), std::greater<>());
    const auto same = [](const PieceSplit& a, const PieceSplit& b) { return a.piece == b.piece; };
    splits_.erase(std::unique(splits_.begin(), splits_.end(), same), splits_.end());
    return {{}, {}, std::move(splits_)};
  }

  Point project(const Vec3d& u) const {
    const PlanePoint p = plane_.project(u);
    return {p.x, p.y};
  }

  void want_splits(const std::vector<std::uint32_t>& pieces) {
    for (const std::uint32_t piece : pieces) want_split(piece);
  }

  // Whether all pieces are edges of the triangulation. Curves side by side take many rounds to
  // part (a hundred places where they cross, halved in each round), and points all but on one
  // circle are slow to triangulate: where only validity is asked for, crossings are looked for
  // without a triangulation first.
  bool insert_boundary() {
    want_splits(flat_.doubled_pieces());
    if (splits_.empty() && options_.demand == Demand::validity) {
      want_splits(flat_.crossings(options_.monitor));
    }
    if (!splits_.empty()) return false;
    FaceHandle hint;
    handles_.resize(b_.points.size());
    for (const std::uint32_t i : insertion_order(b_)) {
      check_cancelled(options_.monitor, i);
      handles_[i] = planar_.insert(flat_.point(i), hint);
      handles_[i]->info() = i;
      hint = handles_[i]->face();
    }
    for (std::uint32_t p = 0; p < b_.pieces.size() && splits_.empty(); ++p) insert_piece(p);
    return splits_.empty();
  }

  void insert_piece(std::uint32_t p) {
    check_cancelled(options_.monitor, p);
    try {
      planar_.insert_constraint(handles_[b_.pieces[p].from], handles_[b_.pieces[p].to]);
    } catch (const Planar::Intersection_of_constraints_exception&) {
      want_splits(flat_.crossings_of(p));
    }
  }

  // Marks the faces on the left of the pieces; false where the boundary does not separate them.
  bool mark_inside() {
    for (const FaceHandle f : planar_.all_face_handles()) f->info().inside = false;
    std::vector<FaceHandle> stack;
    const auto visit = [&](FaceHandle f) {
      if (f->info().inside) return;
      f->info().inside = true;
      stack.push_back(f);
    };
    for (std::uint32_t p = 0; p < b_.pieces.size(); ++p) {
      FaceHandle right;
      int edge;
      if (planar_.is_edge(handles_[b_.pieces[p].from], handles_[b_.pieces[p].to], right, edge)) {
        visit(right->neighbor(edge));
      } else {
        want_split(p);
      }
    }
    while (!stack.empty()) {
      const FaceHandle f = stack.back();
      stack.pop_back();
      for (int k = 0; k < 3; ++k) {
        if (!f->is_constrained(k)) visit(f->neighbor(k));
      }
    }
    if (splits_.empty()) split_leaks();
    return splits_.empty();
  }

  // Where a boundary lies on the far side of another's chords, what was marked leaks past them. The
  // chord that is too coarse is among those with marks on both sides, and not among the short ones.
  void split_leaks() {
    std::vector<std::uint32_t> leaks;
    double longest = 0;
    for (std::uint32_t p = 0; p < b_.pieces.size(); ++p) {
      FaceHandle right;
      int edge;
      planar_.is_edge(handles_[b_.pieces[p].from], handles_[b_.pieces[p].to], right, edge);
      if (!right->info().inside && !planar_.is_infinite(right->neighbor(edge))) continue;
      leaks.push_back(p);
      longest = std::max(longest, chord(p));
    }
    for (const std::uint32_t p : leaks) {
      if (chord(p) >= longest / 2) want_split(p);
    }
  }

  double chord(std::uint32_t p) const {
    return norm(points_[b_.pieces[p].to] - points_[b_.pieces[p].from]);
  }

  bool is_inside(FaceHandle f) const { return f->info().inside && !planar_.is_infinite(f); }

  const Vec3d& at(VertexHandle v) const { return points_[v->info()]; }

  // Pieces that are long beside the width of the patch there.
  void find_crowded() {
    if (options_.demand == Demand::validity) return;
    for (const FaceHandle f : planar_.finite_face_handles()) {
      if (!is_inside(f)) continue;
      for (int k = 0; k < 3; ++k) {
        if (f->is_constrained(k)) look_from(f, k);
      }
    }
  }

  void look_from(FaceHandle f, int k) {
    const VertexHandle va = f->vertex(f->ccw(k)), vb = f->vertex(f->cw(k)), vp = f->vertex(k);
    const std::uint32_t piece = flat_.piece_between(va->info(), vb->info());
    if (circles_.on(vp->info(), b_.pieces[piece].neighbor)) return;
    const Vec3d &a = at(va), &b = at(vb), &p = at(vp);
    const double length = norm(b - a);
    if (length <= kShortest * h_) return;
    for (const int other : {f->ccw(k), f->cw(k)}) {
      // Edge `other` is opposite to that end, so it starts at the other one.
      if (!f->is_constrained(other)) continue;
      const double beside = other == f->ccw(k) ? norm(p - b) : norm(p - a);
      if (length > kCornerRatio * beside) want_split(piece);
      return;
    }
    if (const std::uint32_t halvings = halvings_for_width(a, b, p)) want_split(piece, halvings);
  }

  void insert_lattice() {
    std::vector<double> margins;
    for (const CoveredCap& cap : b_.caps) {
      const double angle = std::acos(std::clamp(cap.cosine, -1.0, 1.0)) + kLatticeMargin * h_;
      margins.push_back(angle < kPi ? std::cos(angle) : -2);
    }
    FaceHandle hint;
    for (const Vec3d& u : clear_points(b_.caps, margins, sphere_points(h_))) {
      hint = insert_interior(u, hint)->face();
    }
  }

  bool is_buried(const Vec3d& u) const {
    return std::any_of(b_.caps.begin(), b_.caps.end(),
                       [&](const CoveredCap& cap) { return cap.covers(u); });
  }

  VertexHandle insert_interior(const Vec3d& u, FaceHandle hint) {
    const VertexHandle v = planar_.insert(project(u), hint);
    v->info() = static_cast<std::uint32_t>(points_.size());
    points_.push_back(u);
    return v;
  }

  // A face as it was when it was queued.
  struct Candidate {
    FaceHandle face;
    std::array<std::uint32_t, 3> vertices;
  };
  static Candidate candidate(FaceHandle f) {
    return {f, {f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()}};
  }

  FlatCircle circle(FaceHandle f) const {
    return flat_circle({at(f->vertex(0)), at(f->vertex(1)), at(f->vertex(2))},
                       {f->is_constrained(0), f->is_constrained(1), f->is_constrained(2)}, h_);
  }

  // Circumcentres of bad triangles, until there are none or each is too near to the boundary.
  void refine() {
    std::vector<Candidate> queue;
    for (const FaceHandle f : planar_.finite_face_handles()) {
      if (is_inside(f)) queue.push_back(candidate(f));
    }
    const std::size_t most = 20 * (points_.size() + 50);
    for (std::size_t i = 0; i < queue.size() && points_.size() < most; ++i) {
      check_cancelled(options_.monitor, i);
      const Candidate c = queue[i];
      if (candidate(c.face).vertices != c.vertices || !is_inside(c.face)) continue;
      const FlatCircle circumcircle = circle(c.face);
      if (circumcircle.is_bad) try_insert(circumcircle.center, c.face, queue);
    }
  }

  void try_insert(const Vec3d& u, FaceHandle near, std::vector<Candidate>& queue) {
    if (is_buried(u)) return;
    const Point p = project(u);
    Planar::Locate_type type;
    int edge;
    const FaceHandle face = planar_.locate(p, type, edge, near);
    if (type != Planar::FACE && type != Planar::EDGE) return;
    if (!is_inside(face) || (type == Planar::EDGE && face->is_constrained(edge))) return;
    if (crowds_boundary(u, p, face)) return;
    insert_marked(u, face, queue);
  }

  void insert_marked(const Vec3d& u, FaceHandle face, std::vector<Candidate>& queue) {
    const VertexHandle v = insert_interior(u, face);
    auto around = planar_.incident_faces(v), end = around;
    do {
      around->info().inside = true;
      queue.push_back(candidate(around));
    } while (++around != end);
  }

  // Whether a piece next to the place where u would go looks wide from there.
  bool crowds_boundary(const Vec3d& u, const Point& p, FaceHandle face) {
    edges_.clear();
    planar_.get_boundary_of_conflicts(p, std::back_inserter(edges_), face);
    for (const auto& [f, k] : edges_) {
      if (!f->is_constrained(k)) continue;
      const Vec3d a = at(f->vertex(f->ccw(k))) - u, b = at(f->vertex(f->cw(k))) - u;
      if (dot(a, b) < kWidestView * std::sqrt(squared_norm(a) * squared_norm(b))) return true;
    }
    return false;
  }

  // An edge that is no piece of the boundary, seen from one of its two faces.
  struct InnerEdge {
    Candidate candidate;
    int opposite;  // the face's vertex that is not an end
  };

  // The edges inside the patch that join two points of one circle. Each is found from the face in
  // which its lower end comes first: CGAL's own list of edges takes the face at the lower address,
  // and the mesh would depend on where the heap has put the faces.
  std::vector<InnerEdge> edges_within_circles() const {
    std::vector<InnerEdge> found;
    for (const FaceHandle f : planar_.finite_face_handles()) {
      if (!is_inside(f)) continue;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t a = f->vertex(f->ccw(k))->info(), b = f->vertex(f->cw(k))->info();
        if (a < b && !f->is_constrained(k) && circles_.share(a, b)) {
          found.push_back({candidate(f), k});
        }
      }
    }
    return found;
  }

  // Edges inside the patch between two points of one circle get a point in their middle. When that
  // does not get rid of all of them, the pieces at their ends are split: afterwards there is no
  // such edge, or there are splits.
  void separate_circles() {
    constexpr int kMostRounds = 8;
    std::vector<InnerEdge> found = edges_within_circles();
    for (int round = 0; round < kMostRounds && !found.empty(); ++round) {
      for (const auto& [c, k] : found) {
        if (candidate(c.face).vertices == c.vertices) divide_edge(c.face, k);
      }
      found = edges_within_circles();
    }
    for (const auto& [c, k] : found) {
      const auto opposite = static_cast<std::size_t>(k);
      split_pieces_at(c.vertices[(opposite + 1) % 3], c.vertices[(opposite + 2) % 3]);
    }
  }

  // Every piece that ends in one of the two points.
  void split_pieces_at(std::uint32_t a, std::uint32_t b) {
    for (std::uint32_t p = 0; p < b_.pieces.size(); ++p) {
      const BoundaryPiece& piece = b_.pieces[p];
      if (piece.from == a || piece.to == a || piece.from == b || piece.to == b) want_split(p);
    }
  }

  // In the middle of its great circle, which lies outside the patch where the circle of both ends
  // is a large part of the sphere; that of the edge in the plane lies inside.
  void divide_edge(FaceHandle f, int k) {
    const VertexHandle a = f->vertex(f->ccw(k)), b = f->vertex(f->cw(k));
    const Vec3d sum = at(a) + at(b);
    if (squared_norm(sum) > 0 && divide_at(unit(sum), f)) return;
    const Point middle = CGAL::midpoint(a->point(), b->point());
    divide_at(plane_.lift({middle.x(), middle.y()}), f);
  }

  // A point there, or a piece that is split, or false.
  bool divide_at(const Vec3d& u, FaceHandle near) {
    if (u == plane_.pole()) return false;
    Planar::Locate_type type;
    int edge;
    const FaceHandle face = planar_.locate(project(u), type, edge, near);
    if (type == Planar::EDGE && face->is_constrained(edge)) {
      want_split(flat_.piece_between(face->vertex(face->ccw(edge))->info(),
                                     face->vertex(face->cw(edge))->info()));
      return true;
    }
    if ((type != Planar::FACE && type != Planar::EDGE) || !is_inside(face)) return false;
    std::vector<Candidate> unused;
    insert_marked(u, face, unused);
    return true;
  }

  std::vector<PatchTriangle> numbered_triangles() {
    std::vector<FaceHandle> faces;
    for (const FaceHandle f : planar_.finite_face_handles()) {
      if (!is_inside(f)) continue;
      f->info().number = static_cast<std::uint32_t>(faces.size());
      faces.push_back(f);
    }
    std::vector<PatchTriangle> triangles(faces.size());
    for (std::size_t t = 0; t < faces.size(); ++t) {
      const FaceHandle f = faces[t];
      for (int k = 0; k < 3; ++k) {
        const auto slot = static_cast<std::size_t>(k);
        const bool is_piece = f->is_constrained(k);
        triangles[t].vertices[slot] = f->vertex(k)->info();
        triangles[t].neighbors[slot] = is_piece ? kNoNeighbor : f->neighbor(k)->info().number;
        triangles[t].pieces[slot] = is_piece ? flat_.piece_between(f->vertex(f->ccw(k))->info(),
                                                                   f->vertex(f->cw(k))->info())
                                             : kNoPiece;
      }
    }
    return triangles;
  }

  PatchMesh finish(const PatchTriangles& patch) const {
    PatchMesh out;
    // Points that ended up outside the patch are left out.
    std::vector<std::uint32_t> number(patch.points.size(), kNoNeighbor);
    for (std::uint32_t i = 0; i < b_.points.size(); ++i) number[i] = i;
    for (const PatchTriangle& t : patch.triangles) {
      std::array<std::uint32_t, 3> vertices{};
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& n = number[t.vertices[k]];
        if (n == kNoNeighbor) {
          n = static_cast<std::uint32_t>(b_.points.size() + out.interior.size());
          out.interior.push_back(patch.points[t.vertices[k]]);
        }
        vertices[k] = n;
      }
      out.triangles.push_back(vertices);
    }
    return out;
  }

  static constexpr double kShortest = 1e-3;  // by the edge length: not split for quality

  const PatchBoundary& b_;
  double h_;
  PatchOptions options_;
  Stereographic plane_;
  FlatBoundary flat_;
  PointCircles circles_;
  Planar planar_;
  std::vector<Vec3d> points_;
  std::vector<VertexHandle> handles_;
  std::vector<Planar::Edge> edges_;
  std::vector<PieceSplit> splits_;
};

}  // namespace

PatchMesh mesh_patch(const PatchBoundary& boundary, const PatchOptions& options) {
  return PlanarPatch(boundary, options).run();
}

}  // namespace vdwmesh
