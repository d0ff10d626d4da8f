// A constrained Delaunay triangulation of points in the plane, built by inserting points one by one
// and flipping edges (Lawson 1977, "Software for C1 surface interpolation"). A *piece* is a
// constrained edge, which has a number. Triangles and vertices are indices into arrays, which keep
// their memory from one patch to the next.
//
// All points lie in a frame, a triangle whose corners are vertices of the triangulation as well.
// Inside a polygon of constrained edges the triangles do not depend on what lies outside it, so the
// frame need not be far away.
//
// Tests are exact (plane_predicates.hpp). Double decides nearly all of them, and exact arithmetic
// the rest on the host. On the device, a test that double cannot decide makes the triangulation
// fail (patch_memory.hpp). plane_insertion.hpp has the steps, for host and device.
//
// Ties: symmetric patches, and the lattice inside of them, have many points on one circle. Rounding
// must not decide between their edges, or a molecule would get other triangles after a translation.
// So if four points were sampled from one circle, or lie on one within kTie, both diagonals are
// Delaunay, and the present one stays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "creases/arcs/point_circles.hpp"
#include "creases/patch/patch_memory.hpp"
#include "creases/plane/linked_triangle.hpp"

namespace vdwmesh {

template <class Memory>
class PlaneTriangulationOf : public PlaneTypes {
 public:
  template <class T>
  using Array = typename Memory::template Array<T>;

  using Circles = PointCirclesOf<Memory>;

  PlaneTriangulationOf() = default;
  VDWMESH_HD explicit PlaneTriangulationOf(const Memory& memory) : memory_(memory) {}

  // Starts anew with the given points, which are the vertices 0, 1, ..., but are not inserted yet.
  // The frame is made so large that it contains them. `circles` says which of them lie on one
  // circle, and must outlive the use. If it is null, only points that lie exactly on one circle
  // are a tie. Precondition: coordinates of at most kLargestCoordinate / 4.
  VDWMESH_HD void start(std::span<const PlanePoint> points, const Circles* circles);
  // save() copies the triangulation to `state`, and resume() goes on from it.
  void save(State& state) const;
  void resume(const State& state, const Circles* circles);
  // The same without a copy: swap(s), resume_swapped(more, circles), any use, swap(s). In between
  // the triangulation works in the arrays of s, with room for `more_points` further points and
  // their triangles.
  void swap(State& state);
  void resume_swapped(std::size_t more_points, const Circles* circles);
  // Goes on from a state in plain arrays. `largest` is State::largest; plane_points and star have
  // `points` elements, linked has `triangles`.
  VDWMESH_HD void resume(double largest, const PlanePoint* plane_points, const std::uint32_t* star,
                         std::size_t points, const LinkedTriangle* linked, std::size_t triangles,
                         const Circles* circles);

  // Adds a point, not inserted yet, and returns its vertex. Precondition: it lies in the frame.
  VDWMESH_HD std::uint32_t add_point(const PlanePoint& p);

  // Finds a point, searching from a triangle near it. Points outside the frame are `outside`.
  VDWMESH_HD Location locate(const PlanePoint& p, std::uint32_t near);
  // Inserts a vertex at its location, which must be inside a triangle or on an edge that is no
  // piece.
  VDWMESH_HD void insert(std::uint32_t vertex, const Location& at);
  // Makes the edge from vertex `from` to vertex `to` a piece.
  VDWMESH_HD Outcome insert_piece(std::uint32_t from, std::uint32_t to, std::uint32_t piece);

  // Makes the piece from vertex `from` to vertex `to` an edge like others.
  VDWMESH_HD void remove_piece(std::uint32_t from, std::uint32_t to);

  // The pieces around the region that the insertion of p would retriangulate, as edges of triangles
  // inside of it. `at` is the triangle that p lies in. The span is valid until the next call.
  VDWMESH_HD std::span<const TriangleEdge> pieces_around(const PlanePoint& p, std::uint32_t at);

  // The triangles that meet a disk, and some near it. `from` must be one that meets it. For the
  // host. The span is valid until the next call.
  std::span<const std::uint32_t> triangles_at_disk(const PlanePoint& center, double radius,
                                                   std::uint32_t from);

  VDWMESH_HD std::span<const LinkedTriangle> triangles() const { return triangles_; }
  VDWMESH_HD const LinkedTriangle& triangle(std::uint32_t t) const { return triangles_[t]; }
  // A triangle at a vertex.
  VDWMESH_HD std::uint32_t triangle_at(std::uint32_t vertex) const {
    return star_[vertex + kFrameCorners];
  }
  VDWMESH_HD const PlanePoint& point(std::uint32_t vertex) const {
    return points_[vertex + kFrameCorners];
  }
  // Calls visit(t) for each triangle t around a vertex, counter-clockwise.
  template <class Visit>
  VDWMESH_HD void visit_star(std::uint32_t vertex, const Visit& visit) const {
    const std::uint32_t first = triangle_at(vertex);
    std::uint32_t t = first;
    do {
      visit(t);
      t = after(vertex, t);
    } while (t != first);
  }
  // Whether a triangle has a corner of the frame.
  VDWMESH_HD bool touches_frame(std::uint32_t t) const {
    const auto& v = triangles_[t].vertices;
    return is_frame(v[0]) || is_frame(v[1]) || is_frame(v[2]);
  }

  VDWMESH_HD bool is_on_piece(const Location& at) const {
    return at.place == Place::on_edge && triangles_[at.triangle].pieces[at.corner] != kNoPiece;
  }

  // Whether a triangle is marked as inside a patch. Triangles that an insertion makes of a marked
  // triangle are marked, too. Pieces, which are never flipped, must part marked triangles from
  // others, so that flips keep the marks right.
  VDWMESH_HD bool is_inside(std::uint32_t t) const { return inside_[t] == Side::inside; }
  VDWMESH_HD void mark_inside(std::uint32_t t) { inside_[t] = Side::inside; }

  // Whether one more point can be added and inserted. If not, bounded memory has failed.
  VDWMESH_HD bool has_room() const {
    return memory_.has_room(points_, 1) && memory_.has_room(star_, 1) &&
           memory_.has_room(triangles_, 2) && memory_.has_room(inside_, 2);
  }
  VDWMESH_HD bool has_failed() const { return memory_.has_failed(); }
  // Gives up this patch because an angle is too small: bounded memory fails.
  VDWMESH_HD void leave_small_angle() const { memory_.leave_small_angle(); }
  // Calls visit(array, kind) for each array of the state, in the order of PlaneTypes::State, to
  // give bounded arrays their memory.
  template <class Visit>
  VDWMESH_HD void visit_state(const Visit& visit) {
    visit(points_, PatchArray::plane_points);
    visit(triangles_, PatchArray::triangles);
    visit(star_, PatchArray::plane_points);
  }
  // The same for all other arrays.
  template <class Visit>
  VDWMESH_HD void visit_scratch(const Visit& visit) {
    visit(inside_, PatchArray::triangles);
    visit(stack_, PatchArray::triangles);
    visit(visits_, PatchArray::triangles);
    visit(found_, PatchArray::lists);
    visit(crossed_, PatchArray::insertions);
    visit(flipped_, PatchArray::insertions);
  }

  // How many tests had to be decided in exact arithmetic since start().
  VDWMESH_HD std::uint64_t exact_tests() const { return exact_tests_; }

 private:
  // The bodies of locate() and insert().
  VDWMESH_HD Location locate_here(const PlanePoint& p, std::uint32_t near);
  VDWMESH_HD void insert_here(std::uint32_t vertex, const Location& at);

  // Frame corners have the vertices -3, -2 and -1 modulo 2^32, so that adding kFrameCorners gives
  // the index of any vertex in the arrays.
  static constexpr std::uint32_t kFrameCorners = 3, kFirstFrameCorner = 0u - kFrameCorners;
  static constexpr std::uint32_t kInside = 3;  // in place of a corner
  static constexpr std::uint32_t kNoVertex = kFirstFrameCorner - 1;
  VDWMESH_HD static bool is_frame(std::uint32_t vertex) { return vertex >= kFirstFrameCorner; }

  VDWMESH_HD void reset_scratch(const Circles* circles);
  VDWMESH_HD int orientation(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c);
  VDWMESH_HD int orientation_of(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  VDWMESH_HD int orientation_of_point(std::uint32_t a, std::uint32_t b, const PlanePoint& p);
  VDWMESH_HD int in_circle(const LinkedTriangle& t, const PlanePoint& p, std::uint32_t vertex);
  VDWMESH_HD bool share_circle(const LinkedTriangle& t, std::uint32_t vertex) const;

  // Where a point lies from a triangle. `beyond` is a corner whose opposite edge parts the point
  // from the triangle, or kInside if there is none. In this case bit k of `on` says whether the
  // point lies on edge k.
  struct EdgeSides {
    std::uint32_t beyond, on;
  };
  VDWMESH_HD EdgeSides sides(const PlanePoint& p, std::uint32_t t, std::uint32_t from);
  VDWMESH_HD static Location location(std::uint32_t t, std::uint32_t on);
  VDWMESH_HD Location search_all(const PlanePoint& p);

  // The triangle after t, counter-clockwise around a vertex. Precondition: no corner of the frame.
  VDWMESH_HD std::uint32_t after(std::uint32_t vertex, std::uint32_t t) const {
    const LinkedTriangle& w = triangles_[t];
    return w.neighbors[corner_after(w.corner_at(vertex))];
  }
  VDWMESH_HD std::uint32_t& star(std::uint32_t vertex) { return star_[vertex + kFrameCorners]; }
  VDWMESH_HD void split(std::uint32_t t, std::uint32_t vertex);
  VDWMESH_HD void flip_edge(std::uint32_t t, std::uint32_t corner);
  VDWMESH_HD void legalize_around_new();
  VDWMESH_HD bool should_flip(std::uint32_t t, std::uint32_t corner);

  VDWMESH_HD bool find_edge(std::uint32_t a, std::uint32_t b, TriangleEdge& edge) const;
  VDWMESH_HD bool find_edge_at(std::uint32_t a, std::uint32_t b, TriangleEdge& edge) const;
  VDWMESH_HD bool find_listed(const ListedEdge& listed, TriangleEdge& edge) const;
  VDWMESH_HD Outcome set_piece(const TriangleEdge& edge, std::uint32_t piece);
  VDWMESH_HD Outcome find_crossed(std::uint32_t from, std::uint32_t to);
  VDWMESH_HD Outcome first_crossed(std::uint32_t from, std::uint32_t to, TriangleEdge& edge);
  VDWMESH_HD void flip_crossed(std::uint32_t from, std::uint32_t to);
  VDWMESH_HD void legalize_flipped(std::uint32_t from, std::uint32_t to);

  // Absolute values of coordinates in the frame are at most this.
  double largest_ = 0;
  PlaneErrors errors_{};
  Memory memory_;
  const Circles* circles_ = nullptr;
  Array<PlanePoint> points_;
  Array<LinkedTriangle> triangles_;
  Array<std::uint32_t> star_;  // by vertex: a triangle at it
  // An enumeration and no std::uint8_t: a character may alias everything, so the compiler would
  // load all members again after each write.
  enum class Side : std::uint8_t { outside, inside };
  Array<Side> inside_;           // by triangle
  Array<std::uint32_t> stack_;   // scratch memory: triangles to look at
  Array<std::uint32_t> visits_;  // by triangle: the last search that came by
  Array<TriangleEdge> found_;
  Array<ListedEdge> crossed_, flipped_;  // scratch memory of insert_piece()
  std::uint32_t search_ = 0;             // number of the last search
  std::uint32_t turn_ = 0;               // the corner whose edge locate() tests first
  std::uint64_t exact_tests_ = 0;
};

using PlaneTriangulation = PlaneTriangulationOf<GrowingMemory>;

// The triangulation of the host is compiled in plane_triangulation.cpp, locate() and insert() for
// two generations of processors (core/lanes/multiversion.hpp).
template <>
PlaneTypes::Location PlaneTriangulation::locate(const PlanePoint& p, std::uint32_t near);
template <>
void PlaneTriangulation::insert(std::uint32_t vertex, const Location& at);
extern template class PlaneTriangulationOf<GrowingMemory>;

}  // namespace vdwmesh
