// Meshes one patch by constrained Delaunay refinement in the stereographic plane.
//
// Steps: (1) insert the boundary and mark the faces inside it; (2) if quality counts, look for
// pieces that are too long for the patch beside them; (3) fill the inside with points of a
// subdivided icosahedron; (4) insert circumcentres of bad triangles (Chew); (5) divide edges that
// join points of one circle; (6) smooth, and look for invalid triangles.
//
// All steps but (4) may ask for pieces of the boundary to be split. The run then ends after step
// 2, 5 or 6 and returns only these requests. union_mesher.cpp splits the pieces for the patches on
// both sides and calls again. A split for this patch alone would break the seam with the other
// patch.
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
// `inside` says whether a face is part of the patch; `number` numbers the faces that are.
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

// Points of the subdivided icosahedron keep this distance from the arcs, as a fraction of the edge
// length. Points nearer to an arc would make flat triangles with its pieces.
constexpr double kLatticeMargin = 0.55;
// The cosine of the widest angle (110°) under which an inserted point may see a piece. A point that
// sees it under a wider angle would make a flat triangle with it. (Ruppert's algorithm has 90°
// here.)
constexpr double kEncroachCosine = -0.35;
constexpr int kSmoothingPasses = 1;
// The largest edge length, as a fraction of the radius. With longer edges, a patch larger than half
// the sphere might get no interior point. Its triangles would then have all their vertices on the
// boundary and face inwards.
constexpr double kLongestEdge = 1;

// One attempt to mesh one patch; run() lists the steps.
class PatchTriangulator {
 public:
  PatchTriangulator(const PatchBoundary& boundary, const PatchOptions& options)
      : boundary_(boundary),
        edge_length_(std::min(options.edge_length, kLongestEdge)),
        options_(options),
        plane_(buried_pole(boundary)),
        flat_(boundary, plane_),
        circles_(boundary),
        points_(boundary.points) {
    planar_.infinite_vertex()->info() = kNoNeighbor;  // no index into points_
  }

  PatchMesh run() && {
    if (insert_boundary() && mark_inside()) find_long_pieces();
    if (!splits_.empty() || options_.stage == PatchStage::boundary) return requests();
    insert_lattice();
    mark_inside();
    refine();
    divide_edges_within_circles();
    if (!splits_.empty()) return requests();
    PatchTriangles patch{std::move(points_), numbered_triangles()};
    smooth(boundary_, circles_, kSmoothingPasses, patch);
    for (const std::uint32_t piece : defects(boundary_, patch)) want_split(piece);
    if (!splits_.empty()) return requests();
    return finish(patch);
  }

 private:
  // Asks for a piece to be split into 2^halvings parts.
  void want_split(std::uint32_t piece, std::uint32_t halvings = 1) {
    splits_.push_back({boundary_.pieces[piece].source, halvings});
  }

  // A result with the requests only. If a split of one piece was asked for several times, the
  // largest number of halvings counts. It comes first in descending order, and unique() keeps it.
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

  // Step (1): inserts points and pieces. Returns whether all pieces are constraints afterwards; if
  // not, it has asked for splits. If only validity counts, crossings are looked for before anything
  // is triangulated. This finds all crossings of two curves side by side at once, while insertion
  // ends at the first one. It also saves the triangulation of nearly co-circular points, which is
  // slow.
  bool insert_boundary() {
    want_splits(flat_.doubled_pieces());
    if (splits_.empty() && options_.demand == Demand::validity) {
      want_splits(flat_.crossings(options_.monitor));
    }
    if (!splits_.empty()) return false;
    FaceHandle hint;  // where CGAL starts to search for the next point
    handles_.resize(boundary_.points.size());
    for (const std::uint32_t i : insertion_order(boundary_)) {
      check_cancelled(options_.monitor, i);
      handles_[i] = planar_.insert(flat_.point(i), hint);
      handles_[i]->info() = i;
      hint = handles_[i]->face();
    }
    for (std::uint32_t p = 0; p < boundary_.pieces.size() && splits_.empty(); ++p) insert_piece(p);
    return splits_.empty();
  }

  void insert_piece(std::uint32_t p) {
    check_cancelled(options_.monitor, p);
    try {
      planar_.insert_constraint(handles_[boundary_.pieces[p].from],
                                handles_[boundary_.pieces[p].to]);
    } catch (const Planar::Intersection_of_constraints_exception&) {
      want_splits(flat_.crossings_of(p));
    }
  }

  // Marks the faces inside the patch: those on the left of a piece, and all that can be reached
  // from there without crossing a piece. Returns whether the marks are right. They are not, and
  // splits are asked for, if a piece is no edge of the triangulation, because another point lies on
  // it, or if the marks have leaked out of the patch.
  bool mark_inside() {
    for (const FaceHandle f : planar_.all_face_handles()) f->info().inside = false;
    std::vector<FaceHandle> stack;
    const auto visit = [&](FaceHandle f) {
      if (f->info().inside) return;
      f->info().inside = true;
      stack.push_back(f);
    };
    for (std::uint32_t p = 0; p < boundary_.pieces.size(); ++p) {
      FaceHandle right;
      int edge;
      if (planar_.is_edge(handles_[boundary_.pieces[p].from], handles_[boundary_.pieces[p].to],
                          right, edge)) {
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

  // Asks for splits if marks have leaked out of the patch. This happens if a piece is so coarse
  // that another part of the boundary lies between the piece and its arc: there, marking starts on
  // the wrong side of the other part. It shows at pieces with marked faces on both sides, or with
  // the infinite face on their left. The piece to blame is one of these, and it is not short. So
  // every such piece is split that is at least half as long as the longest of them.
  void split_leaks() {
    std::vector<std::uint32_t> leaks;
    double longest = 0;
    for (std::uint32_t p = 0; p < boundary_.pieces.size(); ++p) {
      FaceHandle right;
      int edge;
      planar_.is_edge(handles_[boundary_.pieces[p].from], handles_[boundary_.pieces[p].to], right,
                      edge);
      if (!right->info().inside && !planar_.is_infinite(right->neighbor(edge))) continue;
      leaks.push_back(p);
      longest = std::max(longest, chord(p));
    }
    for (const std::uint32_t p : leaks) {
      if (chord(p) >= longest / 2) want_split(p);
    }
  }

  // The length of a piece on the unit sphere.
  double chord(std::uint32_t p) const {
    return norm(points_[boundary_.pieces[p].to] - points_[boundary_.pieces[p].from]);
  }

  bool is_inside(FaceHandle f) const { return f->info().inside && !planar_.is_infinite(f); }

  const Vec3d& at(VertexHandle v) const { return points_[v->info()]; }

  // Step (2): asks for splits of pieces that are long compared with the width of the patch there.
  void find_long_pieces() {
    if (options_.demand == Demand::validity) return;
    for (const FaceHandle f : planar_.finite_face_handles()) {
      if (!is_inside(f)) continue;
      for (int k = 0; k < 3; ++k) {
        if (f->is_constrained(k)) judge_piece(f, k);
      }
    }
  }

  // Judges the piece that is edge k of face f by the opposite vertex, and asks for a split if it is
  // too long. A vertex on the piece's own circle says nothing about the width. If another edge of
  // the face is a piece too, the two meet at a corner, and only the ratio of their lengths counts.
  void judge_piece(FaceHandle f, int k) {
    const VertexHandle va = f->vertex(f->ccw(k)), vb = f->vertex(f->cw(k)), vp = f->vertex(k);
    const std::uint32_t piece = flat_.piece_between(va->info(), vb->info());
    if (circles_.on(vp->info(), boundary_.pieces[piece].neighbor)) return;
    const Vec3d &a = at(va), &b = at(vb), &p = at(vp);
    const double length = norm(b - a);
    if (length <= kShortest * edge_length_) return;
    for (const int other : {f->ccw(k), f->cw(k)}) {
      // Edge `other` is opposite to one end of the piece, so it starts at the other end.
      if (!f->is_constrained(other)) continue;
      const double beside = other == f->ccw(k) ? norm(p - b) : norm(p - a);
      if (length > kCornerRatio * beside) want_split(piece);
      return;
    }
    if (const std::uint32_t halvings = halvings_for_width(a, b, p)) want_split(piece, halvings);
  }

  // Step (3): inserts the points of the subdivided icosahedron that are outside all caps by the
  // margin. If a cap and its margin cover the whole sphere, the bound of -2 admits no point.
  void insert_lattice() {
    std::vector<double> margins;
    for (const CoveredCap& cap : boundary_.caps) {
      const double angle =
          std::acos(std::clamp(cap.cosine, -1.0, 1.0)) + kLatticeMargin * edge_length_;
      margins.push_back(angle < std::numbers::pi ? std::cos(angle) : -2);
    }
    FaceHandle hint;
    for (const Vec3d& u : clear_points(boundary_.caps, margins, sphere_points(edge_length_))) {
      hint = insert_interior(u, hint)->face();
    }
  }

  bool is_buried(const Vec3d& u) const {
    return std::any_of(boundary_.caps.begin(), boundary_.caps.end(),
                       [&](const CoveredCap& cap) { return cap.covers(u); });
  }

  // Inserts point u of the unit sphere, whose face is near `hint`, and gives it the next number.
  VertexHandle insert_interior(const Vec3d& u, FaceHandle hint) {
    const VertexHandle v = planar_.insert(project(u), hint);
    v->info() = static_cast<std::uint32_t>(points_.size());
    points_.push_back(u);
    return v;
  }

  // A face and its vertices when it was queued. CGAL reuses faces, so a face whose vertices have
  // changed is another triangle.
  struct Candidate {
    FaceHandle face;
    std::array<std::uint32_t, 3> vertices;
  };
  static Candidate candidate(FaceHandle f) {
    return {f, {f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()}};
  }

  FlatCircle circle(FaceHandle f) const {
    return flat_circle({at(f->vertex(0)), at(f->vertex(1)), at(f->vertex(2))},
                       {f->is_constrained(0), f->is_constrained(1), f->is_constrained(2)},
                       edge_length_);
  }

  // Step (4): inserts the circumcentres of bad triangles (patch_quality.hpp) until no triangle is
  // bad or try_insert() has refused the circumcentres of the rest. New faces join the end of the
  // queue. The limit on the number of points ends the loop in any case; some triangles then stay
  // bad.
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

  // Inserts u if it lies inside the patch and not too near to the boundary. `near` is a face from
  // which the search for u starts.
  void try_insert(const Vec3d& u, FaceHandle near, std::vector<Candidate>& queue) {
    if (is_buried(u)) return;
    const Point p = project(u);
    Planar::Locate_type type;
    int edge;
    const FaceHandle face = planar_.locate(p, type, edge, near);
    if (type != Planar::FACE && type != Planar::EDGE) return;
    if (!is_inside(face) || (type == Planar::EDGE && face->is_constrained(edge))) return;
    if (encroaches(u, p, face)) return;
    insert_marked(u, face, queue);
  }

  // Inserts u into a face of the patch. The new faces around u are inside too, and join the queue.
  void insert_marked(const Vec3d& u, FaceHandle face, std::vector<Candidate>& queue) {
    const VertexHandle v = insert_interior(u, face);
    auto around = planar_.incident_faces(v), end = around;
    do {
      around->info().inside = true;
      queue.push_back(candidate(around));
    } while (++around != end);
  }

  // Whether u is too near to a piece: whether it sees one under an angle wider than 110°
  // (kEncroachCosine). Only pieces that would be edges of u's new triangles are tested; they bound
  // the conflict zone, the faces that the insertion of u would replace.
  bool encroaches(const Vec3d& u, const Point& p, FaceHandle face) {
    edges_.clear();
    planar_.get_boundary_of_conflicts(p, std::back_inserter(edges_), face);
    for (const auto& [f, k] : edges_) {
      if (!f->is_constrained(k)) continue;
      const Vec3d a = at(f->vertex(f->ccw(k))) - u, b = at(f->vertex(f->cw(k))) - u;
      if (dot(a, b) < kEncroachCosine * std::sqrt(squared_norm(a) * squared_norm(b))) return true;
    }
    return false;
  }

  // An edge that is no piece of the boundary, seen from one of its two faces.
  struct InnerEdge {
    Candidate candidate;
    int opposite;  // index of the face's vertex that is no end of the edge
  };

  // The edges inside the patch that join two points of one circle. Of the two faces of an edge, the
  // one is taken in which the end of lower number comes first. CGAL's own list of edges would take
  // the face at the lower address, and the mesh would depend on where the heap has put the faces.
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

  // Step (5): inserts points into the middle of edges that join two points of one circle. New edges
  // may join such points again, so this is repeated. For edges that are left after the last round,
  // the pieces at their ends are split: afterwards there is no such edge, or there are requests.
  void divide_edges_within_circles() {
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

  // Asks for splits of all pieces that end in one of the two points.
  void split_pieces_at(std::uint32_t a, std::uint32_t b) {
    for (std::uint32_t p = 0; p < boundary_.pieces.size(); ++p) {
      const BoundaryPiece& piece = boundary_.pieces[p];
      if (piece.from == a || piece.to == a || piece.from == b || piece.to == b) want_split(p);
    }
  }

  // Divides edge k of face f at the middle of the shorter great-circle arc between its ends. If the
  // circle through the ends is large, this point may lie outside the patch. Then the middle of the
  // edge in the plane is taken, which lies inside.
  void divide_edge(FaceHandle f, int k) {
    const VertexHandle a = f->vertex(f->ccw(k)), b = f->vertex(f->cw(k));
    const Vec3d sum = at(a) + at(b);
    if (squared_norm(sum) > 0 && divide_at(unit(sum), f)) return;
    const Point middle = CGAL::midpoint(a->point(), b->point());
    divide_at(plane_.lift({middle.x(), middle.y()}), f);
  }

  // Inserts u into the patch, or asks for a split if u lies on a piece. Returns false, and does
  // nothing, if u lies outside the patch. The pole has no image in the plane and is outside.
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
    std::vector<Candidate> unused;  // the queue of refine(), which has ended
    insert_marked(u, face, unused);
    return true;
  }

  // The faces inside the patch as plain arrays, with the numbers of their neighbours.
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

  // Numbers the interior points that triangles use, in the order of their first use.
  PatchMesh finish(const PatchTriangles& patch) const {
    PatchMesh out;
    // Points that lie outside the patch belong to no triangle and are left out.
    std::vector<std::uint32_t> number(patch.points.size(), kNoNeighbor);
    for (std::uint32_t i = 0; i < boundary_.points.size(); ++i) number[i] = i;
    for (const PatchTriangle& t : patch.triangles) {
      std::array<std::uint32_t, 3> vertices{};
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& n = number[t.vertices[k]];
        if (n == kNoNeighbor) {
          n = static_cast<std::uint32_t>(boundary_.points.size() + out.interior.size());
          out.interior.push_back(patch.points[t.vertices[k]]);
        }
        vertices[k] = n;
      }
      out.triangles.push_back(vertices);
    }
    return out;
  }

  // Pieces shorter than this fraction of the edge length are not split for quality.
  static constexpr double kShortest = 1e-3;

  const PatchBoundary& boundary_;
  double edge_length_;  // as a fraction of the radius, at most kLongestEdge
  PatchOptions options_;
  Stereographic plane_;
  FlatBoundary flat_;
  PointCircles circles_;
  Planar planar_;
  // The points on the sphere, indexed by the info() of vertices: first the points of the boundary,
  // then the interior ones.
  std::vector<Vec3d> points_;
  std::vector<VertexHandle> handles_;  // by point of the boundary
  std::vector<Planar::Edge> edges_;    // scratch memory of encroaches()
  std::vector<PieceSplit> splits_;
};

}  // namespace

PatchMesh mesh_patch(const PatchBoundary& boundary, const PatchOptions& options) {
  return PatchTriangulator(boundary, options).run();
}

}  // namespace vdwmesh
