// Meshes one patch by constrained Delaunay refinement in the stereographic plane, once its boundary
// is triangulated there. For host and device.
//
// Steps: (1) mark the triangles inside the boundary; (2) if quality counts, look for pieces that
// are too long for the patch beside them; (3) fill the inside with points of a subdivided
// icosahedron; (4) insert circumcentres of bad triangles (Chew); (5) divide edges that join points
// of one circle; (6) smooth, and look for invalid triangles.
//
// All steps but (4) may ask for pieces of the boundary to be split. The run then ends after step
// 2, 5 or 6 and returns only these requests. union_mesher.cpp splits the pieces for the patches on
// both sides and calls again. A split for this patch alone would break the seam with the other
// patch.
//
// The template is for patch_mesher.cpp, which compiles it for the host, and for the kernels of the
// device.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "core/steps.hpp"
#include "creases/arcs/cap_margins.hpp"
#include "creases/patch/angle_floors.hpp"
#include "creases/patch/patch_angles.hpp"
#include "creases/patch/patch_quality.hpp"
#include "creases/patch/patch_work.hpp"
#include "creases/plane/flat_boundary.hpp"
#include "creases/plane/inside_marks.hpp"
#include "creases/plane/patch_leaks.hpp"
#include "creases/plane/stereographic.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh {

class Monitor;
namespace triangulator {

// Points of the subdivided icosahedron keep this distance from the arcs, as a fraction of the edge
// length. Points nearer to an arc would make flat triangles with its pieces.
inline constexpr double kLatticeMargin = 0.55;
inline constexpr int kSmoothingPasses = 1;
// And so often at most where an angle is below its floor.
inline constexpr int kMoreSmoothingPasses = 4;
// The largest edge length, as a fraction of the radius. With longer edges, a patch larger than half
// the sphere might get no interior point. Its triangles would then have all their vertices on the
// boundary and face inwards.
inline constexpr double kLongestEdge = 1;

// One attempt to mesh one patch; run() lists the steps. Lattice has the divided icosahedron's
// points(edge_length in radii, margins) to loop over, at least those clear of the margins.
template <class Memory, class Lattice>
class PatchTriangulator {
 public:
  using Plane = PlaneTriangulationOf<Memory>;
  using Location = PlaneTypes::Location;
  using Place = PlaneTypes::Place;
  template <class T>
  using Array = typename Memory::template Array<T>;

  // Precondition: work.circles are those of the boundary, and work.plane has triangulated it, as
  // projected from buried_pole(). `widest_view` as in PatchOptions. The monitor is not for the
  // device.
  VDWMESH_HD PatchTriangulator(const PatchBoundaryView& boundary, double edge_length,
                               Lattice& lattice, PatchWork<Memory>& work, Monitor* monitor,
                               double widest_view = kWidestView)
      : boundary_(boundary),
        edge_length_(edge_length < kLongestEdge ? edge_length : kLongestEdge),
        widest_view_(widest_view),
        monitor_(monitor),
        steps_(monitor),
        caps_(boundary.caps),
        projection_(buried_pole(boundary)),
        lattice_(lattice),
        work_(work),
        circles_(work.circles),
        plane_(work.plane),
        numbers_(work.numbers),
        patch_(work.patch),
        points_(work.patch.points),
        splits_(work.splits) {}

  // Pieces may be split so that angles keep a bound. Not for the device.
  void bound_angles(const AngleBound& angles) {
    angles_ = &angles;
    bad_sine_ = std::max(kBadAngleSine, angles.sine_before_smoothing());
  }

  // The patch is smoothed more often, and pieces are split, for the floors. Not for the device.
  void keep_floors(const AngleFloors& floors) { floors_ = &floors; }

  // Fills work.splits, or else, after the stage of triangles, the interior points and triangles,
  // and returns whether these have an angle below kFloorOfAngles.
  VDWMESH_HD bool run(Demand demand, PatchStage stage) {
    splits_.clear();
    work_.interior.clear();
    work_.triangles.clear();
    points_.assign(boundary_.points.data(), boundary_.points.data() + boundary_.points.size());
    if (mark_inside() && demand == Demand::quality) find_long_pieces();
    if (!splits_.empty() || stage == PatchStage::boundary) return false;
    insert_lattice();
    refine();
    divide_edges_within_circles();
    ask_for_angles();
    if (!splits_.empty() || plane_.has_failed()) return false;
    collect_triangles();
    smooth<Memory>(boundary_, circles_, kSmoothingPasses, work_.smoothing, patch_);
    ask_for_smoothed_angles();
    const bool has_small_angle = ask_for_valid_triangles() && !raise_angles();
    if (splits_.empty()) finish();
    return has_small_angle && splits_.empty();
  }

 private:
  // On the host the monitor is asked once in some steps.
  VDWMESH_HD void count_steps(std::size_t steps) {
    if constexpr (!Memory::kIsBounded) steps_.add(steps);
  }

  // On the host an array that is about to be filled has room for `most` elements at once: copies of
  // the millions of a large patch, while its array grows, would cost more than they do.
  template <class List>
  VDWMESH_HD static void make_room(List& array, std::size_t most) {
    if constexpr (!Memory::kIsBounded) array.reserve(most);
  }

  // Asks for a piece to be split into 2^halvings parts.
  VDWMESH_HD void want_split(std::uint32_t piece, std::uint32_t halvings = 1) {
    splits_.push_back({boundary_.pieces[piece].source, halvings});
  }

  // If angles are bounded, ask for splits of pieces in the way of larger ones: of the triangles in
  // the plane, and after the smoothing of those of patch_.
  VDWMESH_HD void ask_for_angles() {
    if constexpr (!Memory::kIsBounded) {
      if (angles_) angles_->find_in_plane(plane_, points_, projection_, splits_);
    }
  }
  VDWMESH_HD void ask_for_smoothed_angles() {
    if constexpr (!Memory::kIsBounded) {
      if (angles_) angles_->find_in_patch(patch_, splits_);
    }
  }

  // After the smoothing: asks for splits where triangles are not valid. Returns whether all are
  // valid, nothing else was asked for, and an angle is below kFloorOfAngles.
  VDWMESH_HD bool ask_for_valid_triangles() {
    work_.pieces.clear();
    const bool has_small_angle = find_defects<Memory>(boundary_, patch_, work_.pieces);
    for (const std::uint32_t piece : work_.pieces) want_split(piece);
    return has_small_angle && splits_.empty();
  }

  // Some angles may be below their floors: on the device the patch is the host's. If they shall
  // keep them, smooths the patch again, and asks for splits if that does not help. Returns whether
  // no angle is below kFloorOfAngles any more.
  VDWMESH_HD bool raise_angles() {
    if constexpr (Memory::kIsBounded) {
      plane_.leave_small_angle();
    } else {
      if (!floors_) return false;
      for (int pass = 0; pass < kMoreSmoothingPasses && floors_->has_angle_below(patch_); ++pass) {
        smooth<Memory>(boundary_, circles_, 1, work_.smoothing, patch_);
        if (!ask_for_valid_triangles()) return true;
      }
      floors_->find(patch_, splits_);  // none, if no angle is below any more
    }
    return false;
  }

  // Calls visit(t, k) for the triangle t on the left of each piece, whose edge k that is.
  template <class Visit>
  VDWMESH_HD void visit_pieces(const Visit& visit) const {
    visit_listed_pieces(work_.pieces, visit);
  }

  // Marks the triangles inside the patch: those on the left of a piece, and all that can be reached
  // from there without crossing a piece. Returns whether the marks are right. They are not, and
  // splits are asked for, if the marks have leaked out of the patch.
  VDWMESH_HD bool mark_inside() {
    numbers_.clear();
    list_pieces(boundary_, plane_, work_.pieces);
    visit_pieces([&](std::uint32_t t, std::uint32_t) { mark_and_list(plane_, t, numbers_); });
    mark_reachable(plane_, numbers_);
    split_leaks(
        boundary_, projection_, work_, [&](std::uint32_t piece) { want_split(piece); },
        [&] { count_steps(1); });
    return splits_.empty();
  }

  // Step (2): asks for splits of pieces that are long compared with the width of the patch there.
  // Since no marks have leaked, each piece has one triangle inside the patch, on its left.
  VDWMESH_HD void find_long_pieces() {
    visit_pieces([&](std::uint32_t t, std::uint32_t k) { judge_piece(plane_.triangle(t), k); });
  }

  // Judges the piece that is edge k of a triangle by the opposite vertex, and asks for a split if
  // it is too long. A vertex on the piece's own circle says nothing about the width. If another
  // edge of the triangle is a piece too, the two meet at a corner, and only the ratio of their
  // lengths counts.
  VDWMESH_HD void judge_piece(const LinkedTriangle& t, std::uint32_t k) {
    const std::uint32_t k1 = corner_after(k), k2 = corner_before(k), piece = t.pieces[k];
    if (circles_.on(t.vertices[k], boundary_.pieces[piece].neighbor)) return;
    const Vec3d &a = points_[t.vertices[k1]], &b = points_[t.vertices[k2]],
                &p = points_[t.vertices[k]];
    const std::uint32_t sides[2] = {k1, k2};
    for (const std::uint32_t other : sides) {
      // Edge `other` is opposite to one end of the piece, so it starts at the other end.
      if (t.pieces[other] == kNoPiece) continue;
      if (is_long_at_corner(a, b, other == k1 ? b : a, p)) want_split_for_quality(piece, a, b);
      return;
    }
    if (const std::uint32_t halvings = halvings_for_width(a, b, p)) {
      want_split_for_quality(piece, a, b, halvings);
    }
  }
  VDWMESH_HD void want_split_for_quality(std::uint32_t piece, const Vec3d& a, const Vec3d& b,
                                         std::uint32_t halvings = 1) {
    if (norm(b - a) > kShortest * edge_length_) want_split(piece, halvings);
  }

  // Step (3): inserts the points of the subdivided icosahedron that are outside all caps by the
  // margin.
  VDWMESH_HD void insert_lattice() {
    CapMargins<Memory> margins(boundary_.caps, kLatticeMargin * edge_length_, work_.margins);
    if constexpr (!Memory::kIsBounded) caps_.build(margins.bounds(), monitor_);
    std::uint32_t near = plane_.triangle_at(0);
    for (const Vec3d& u : lattice_.points(edge_length_, margins)) {
      count_steps(caps_.tests(u));
      if (!margins.is_clear(u, caps_)) continue;
      const PlanePoint p = projection_.project(u);
      const Location at = plane_.locate(p, near);
      near = at.triangle;
      if (is_free(at)) near = plane_.triangle_at(insert_interior(u, p, at));
    }
  }

  VDWMESH_HD bool is_buried(const Vec3d& u) const {
    return caps_.holds_for_any(u, [&](std::size_t i) { return boundary_.caps[i].covers(u); });
  }

  // Whether a location is inside the patch, and neither a vertex nor on a piece; and whether there
  // is room for a point.
  VDWMESH_HD bool is_free(const Location& at) const {
    return (at.place == Place::inside || at.place == Place::on_edge) && !plane_.is_on_piece(at) &&
           plane_.is_inside(at.triangle) && !plane_.has_failed() && plane_.has_room();
  }

  // Inserts point u of the unit sphere, whose image p is at a free location. Returns its number.
  VDWMESH_HD std::uint32_t insert_interior(const Vec3d& u, const PlanePoint& p,
                                           const Location& at) {
    const std::uint32_t vertex = plane_.add_point(p);
    points_.push_back(u);
    plane_.insert(vertex, at);
    return vertex;
  }

  using Candidate = TriangleCandidate;
  VDWMESH_HD Candidate candidate(std::uint32_t t) const { return {t, plane_.triangle(t).vertices}; }
  // By elements: nvcc 13.0 compiles the comparison of two std::arrays, which is a call of memcmp,
  // to one on the device that never holds.
  VDWMESH_HD bool is_unchanged(const Candidate& c) const {
    const auto &now = plane_.triangle(c.triangle).vertices, &then = c.vertices;
    return now[0] == then[0] && now[1] == then[1] && now[2] == then[2];
  }

  VDWMESH_HD std::array<Vec3d, 3> corners(std::uint32_t t) const {
    const auto& v = plane_.triangle(t).vertices;
    return {points_[v[0]], points_[v[1]], points_[v[2]]};
  }

  VDWMESH_HD void queue_if_bad(std::uint32_t t) {
    const auto& pieces = plane_.triangle(t).pieces;
    const std::array<bool, 3> constrained{pieces[0] != kNoPiece, pieces[1] != kNoPiece,
                                          pieces[2] != kNoPiece};
    if (is_bad(corners(t), constrained, edge_length_,
               Memory::kIsBounded ? kBadAngleSine : bad_sine_)) {
      work_.queue.push_back(candidate(t));
    }
  }

  // Step (4): inserts the circumcentres of bad triangles (patch_quality.hpp) until no triangle is
  // bad or try_insert() has refused the circumcentres of the rest. New triangles join the end of
  // the queue. The limit on the number of points ends the loop in any case; some triangles then
  // stay bad.
  VDWMESH_HD void refine() {
    work_.queue.clear();
    visit_marked(plane_, [&](std::uint32_t t) { queue_if_bad(t); });
    const std::size_t most = 20 * (points_.size() + 50);
    for (std::size_t i = 0; i < work_.queue.size() && points_.size() < most; ++i) {
      if (plane_.has_failed()) return;
      count_steps(1);
      const Candidate c = work_.queue[i];
      if (is_unchanged(c)) try_insert(circumcenter(corners(c.triangle)), c.triangle);
    }
  }

  // Inserts u if it lies inside the patch and not too near to the boundary. `near` is a triangle
  // from which the search for u starts.
  VDWMESH_HD void try_insert(const Vec3d& u, std::uint32_t near) {
    count_steps(caps_.tests(u));
    if (is_buried(u)) return;
    const PlanePoint p = projection_.project(u);
    const Location at = plane_.locate(p, near);
    if (!is_free(at) || encroaches(u, p, at)) return;
    const std::uint32_t vertex = insert_interior(u, p, at);
    plane_.visit_star(vertex, [&](std::uint32_t t) { queue_if_bad(t); });
  }

  // Whether u is too near to a piece: whether it sees one under too wide an angle. (AngleBound asks
  // which of them is seen under the widest one, and needs a quotient for that.) Only pieces that
  // would be edges of u's new triangles are tested; they bound the conflict zone, the triangles
  // that the insertion of u would replace.
  VDWMESH_HD bool encroaches(const Vec3d& u, const PlanePoint& p, const Location& at) {
    for (const auto& [t, k] : plane_.pieces_around(p, at.triangle)) {
      const auto& v = plane_.triangle(t).vertices;
      const Vec3d a = points_[v[corner_after(k)]] - u, b = points_[v[corner_before(k)]] - u;
      if (dot(a, b) < widest_view_ * std::sqrt(squared_norm(a) * squared_norm(b))) return true;
    }
    return false;
  }

  // The edges inside the patch that join two points of one circle. Of the two triangles of an edge,
  // the one is taken in which the end of lower number comes first.
  VDWMESH_HD void find_edges_within_circles() {
    Array<InnerEdge>& found = work_.inner_edges;
    found.clear();
    visit_marked(plane_, [&](std::uint32_t t) {
      const LinkedTriangle& w = plane_.triangle(t);
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t a = w.vertices[corner_after(k)], b = w.vertices[corner_before(k)];
        if (a < b && w.pieces[k] == kNoPiece && circles_.share(a, b)) {
          found.push_back({candidate(t), k});
        }
      }
    });
  }

  // Step (5): inserts points into the middle of edges that join two points of one circle. New edges
  // may join such points again, so this is repeated. For edges that are left after the last round,
  // the pieces at their ends are split: afterwards there is no such edge, or there are requests.
  VDWMESH_HD void divide_edges_within_circles() {
    constexpr int kMostRounds = 8;
    const Array<InnerEdge>& found = work_.inner_edges;
    find_edges_within_circles();
    for (int round = 0; round < kMostRounds && !found.empty() && !plane_.has_failed(); ++round) {
      for (const auto& [c, k] : found) {
        count_steps(1);
        if (is_unchanged(c)) divide_edge(c.triangle, k);
      }
      find_edges_within_circles();
    }
    if (!found.empty()) split_pieces_at_ends_of(found);
  }

  // Asks for splits of all pieces that end where an edge does.
  VDWMESH_HD void split_pieces_at_ends_of(const Array<InnerEdge>& edges) {
    numbers_.assign(boundary_.points.size(), std::uint32_t{0});
    for (const auto& [c, k] : edges) {
      numbers_[c.vertices[corner_after(k)]] = numbers_[c.vertices[corner_before(k)]] = 1;
    }
    for (std::uint32_t p = 0; p < boundary_.pieces.size(); ++p) {
      if (numbers_[boundary_.pieces[p].from] || numbers_[boundary_.pieces[p].to]) want_split(p);
    }
  }

  // Divides edge k of triangle t at the middle of the shorter great-circle arc between its ends. If
  // the circle through the ends is large, this point may lie outside the patch. Then the middle of
  // the edge in the plane is taken, which lies inside.
  VDWMESH_HD void divide_edge(std::uint32_t t, std::uint32_t k) {
    const auto& v = plane_.triangle(t).vertices;
    const std::uint32_t a = v[corner_after(k)], b = v[corner_before(k)];
    const Vec3d sum = points_[a] + points_[b];
    if (squared_norm(sum) > 0 && divide_at(unit(sum), t)) return;
    const PlanePoint &p = plane_.point(a), &q = plane_.point(b);
    divide_at(projection_.lift({(p.x + q.x) / 2, (p.y + q.y) / 2}), t);
  }

  // Inserts u into the patch, or asks for a split if u lies on a piece. Returns false, and does
  // nothing, if u lies outside the patch. The pole has no image in the plane and is outside.
  VDWMESH_HD bool divide_at(const Vec3d& u, std::uint32_t near) {
    if (u == projection_.pole()) return false;
    const PlanePoint p = projection_.project(u);
    const Location at = plane_.locate(p, near);
    if (plane_.is_on_piece(at)) {
      want_split(plane_.triangle(at.triangle).pieces[at.corner]);
      return true;
    }
    if (!is_free(at)) return false;
    insert_interior(u, p, at);
    return true;
  }

  // Copies the triangles inside the patch to patch_, with the numbers that they have there.
  VDWMESH_HD void collect_triangles() {
    numbers_.assign(plane_.triangles().size(), std::uint32_t{kNoNeighbor});
    patch_.triangles.clear();
    make_room(patch_.triangles, plane_.triangles().size());
    visit_marked(plane_, [&](std::uint32_t t) {
      numbers_[t] = static_cast<std::uint32_t>(patch_.triangles.size());
      patch_.triangles.push_back(plane_.triangle(t));
    });
    for (LinkedTriangle& t : patch_.triangles) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        t.neighbors[k] = t.pieces[k] == kNoPiece ? numbers_[t.neighbors[k]] : kNoNeighbor;
      }
    }
  }

  // Numbers the interior points that triangles use, in the order of their first use.
  VDWMESH_HD void finish() {
    // Points that lie outside the patch belong to no triangle and are left out. numbers_ has room,
    // since there are more triangles in the plane than points.
    numbers_.assign(points_.size(), std::uint32_t{kNoNeighbor});
    for (std::uint32_t i = 0; i < boundary_.points.size(); ++i) numbers_[i] = i;
    make_room(work_.interior, points_.size() - boundary_.points.size());
    make_room(work_.triangles, patch_.triangles.size());
    for (const LinkedTriangle& t : patch_.triangles) {
      std::array<std::uint32_t, 3> vertices{};
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& n = numbers_[t.vertices[k]];
        if (n == kNoNeighbor) {
          n = static_cast<std::uint32_t>(boundary_.points.size() + work_.interior.size());
          work_.interior.push_back(points_[t.vertices[k]]);
        }
        vertices[k] = n;
      }
      work_.triangles.push_back(vertices);
    }
  }

  // Pieces shorter than this fraction of the edge length are not split for quality.
  static constexpr double kShortest = 1e-3;

  PatchBoundaryView boundary_;
  double edge_length_;  // as a fraction of the radius, at most kLongestEdge
  double widest_view_;  // a cosine
  Monitor* monitor_;
  Steps steps_;
  CapTree<Memory> caps_;
  const AngleBound* angles_ = nullptr;
  const AngleFloors* floors_ = nullptr;
  double bad_sine_ = kBadAngleSine;
  Stereographic projection_;
  Lattice& lattice_;
  PatchWork<Memory>& work_;
  // Parts of the work.
  PointCirclesOf<Memory>& circles_;
  Plane& plane_;
  Array<std::uint32_t>& numbers_;
  PatchTrianglesOf<Memory>& patch_;
  // The points on the sphere by vertex: first the points of the boundary, then the interior ones.
  Array<Vec3d>& points_;
  Array<PieceSplit>& splits_;
};

}  // namespace triangulator
}  // namespace vdwmesh
