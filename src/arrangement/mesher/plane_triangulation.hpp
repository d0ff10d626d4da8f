// A constrained Delaunay triangulation of points in the plane, built by inserting points one by one
// and flipping edges (Lawson 1977, "Software for C1 surface interpolation"). Arrays of indices that
// are kept from one patch to the next; no memory is taken per triangle.
//
// All points lie in a frame, a triangle whose corners are vertices of the triangulation as well.
// Inside a polygon of constrained edges the triangles do not depend on what lies outside it, so the
// frame need not be far away.
//
// Tests are exact: plane_predicates.hpp decides nearly all of them in double, and
// exact_plane_predicates.hpp the rest. But where points come from a patch, ties are common and must
// not be decided by rounding, or a molecule would get other triangles after a translation. There
// the edge that is there stays if four points were sampled from one circle, or lie on one but for
// kTie, and either edge between them is as good. Symmetric patches and the lattice inside of them
// have such points.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "arrangement/mesher/linked_triangle.hpp"
#include "arrangement/mesher/patch_boundary.hpp"
#include "arrangement/mesher/plane_predicates.hpp"

namespace vdwmesh {

class PlaneTriangulation {
 public:
  // An edge of a triangle by the number of the opposite corner.
  struct Edge {
    std::uint32_t triangle, corner;
  };
  enum class Place : std::uint8_t { inside, on_edge, on_vertex, outside };
  // Where a point lies. `corner` is that of the vertex, or opposite to the edge, that it lies on.
  struct Location {
    std::uint32_t triangle, corner;
    Place place;
  };
  // What became of a piece that should be an edge. It is crossed by another piece, or joins the
  // same points as another one, or a third point lies on it; only `inserted` makes it one.
  enum class Outcome : std::uint8_t { inserted, doubled, crossing, blocked };

  // Starts anew with the given points, which are the vertices 0, 1, ..., but are not inserted yet.
  // The frame is made so large that it contains them. `circles` says which of them lie on one
  // circle, and must outlive the use. If it is null, nothing is a tie but what exact tests say is
  // one. Precondition: coordinates
  // of at most kLargestCoordinate / 4.
  void start(std::span<const PlanePoint> points, const PointCircles* circles);
  // The points and triangles, without marks. With resume() one can go on from there later.
  struct State {
    double largest = 0;
    std::vector<PlanePoint> points;
    std::vector<LinkedTriangle> triangles;
    std::vector<std::uint32_t> star;
  };
  void save(State& state) const;
  void resume(const State& state, const PointCircles* circles);

  // Adds a point, not inserted yet, and returns its vertex. Precondition: it lies in the frame.
  std::uint32_t add_point(const PlanePoint& p);

  // Finds a point, searching from a triangle near it. Points outside the frame are `outside`.
  Location locate(const PlanePoint& p, std::uint32_t near);
  // Inserts a vertex at its location, which must be inside a triangle or on an edge that is no
  // piece.
  void insert(std::uint32_t vertex, const Location& at);
  // Makes the edge from vertex `from` to vertex `to` a piece.
  Outcome insert_piece(std::uint32_t from, std::uint32_t to, std::uint32_t piece);

  // Makes the piece from vertex `from` to vertex `to` an edge like others.
  void remove_piece(std::uint32_t from, std::uint32_t to);

  // The pieces around the region that the insertion of p would retriangulate, as edges of triangles
  // inside of it. `at` is the triangle that p lies in. The span is valid until the next call.
  std::span<const Edge> pieces_around(const PlanePoint& p, std::uint32_t at);

  std::span<const LinkedTriangle> triangles() const { return triangles_; }
  const LinkedTriangle& triangle(std::uint32_t t) const { return triangles_[t]; }
  // A triangle at a vertex.
  std::uint32_t triangle_at(std::uint32_t vertex) const { return star_[vertex + kFrameCorners]; }
  const PlanePoint& point(std::uint32_t vertex) const { return points_[vertex + kFrameCorners]; }
  // Calls visit(t) for each triangle t around a vertex, counter-clockwise.
  template <class Visit>
  void visit_star(std::uint32_t vertex, const Visit& visit) const {
    const std::uint32_t first = triangle_at(vertex);
    std::uint32_t t = first;
    do {
      visit(t);
      t = after(vertex, t);
    } while (t != first);
  }
  // Whether a triangle has a corner of the frame.
  bool touches_frame(std::uint32_t t) const {
    const auto& v = triangles_[t].vertices;
    return is_frame(v[0]) || is_frame(v[1]) || is_frame(v[2]);
  }

  bool is_on_piece(const Location& at) const {
    return at.place == Place::on_edge && triangles_[at.triangle].pieces[at.corner] != kNoPiece;
  }

  // Whether a triangle is marked as inside a patch. Triangles that an insertion makes of a marked
  // triangle are marked, too; flips never join marked and unmarked triangles, if pieces part them.
  bool is_inside(std::uint32_t t) const { return inside_[t] != 0; }
  void mark_inside(std::uint32_t t) { inside_[t] = 1; }

  // How many tests had to be decided in exact arithmetic since start().
  std::uint64_t exact_tests() const { return exact_tests_; }

 private:
  // Frame corners have the vertices -3, -2 and -1 modulo 2^32, so that adding kFrameCorners gives
  // the index of any vertex in the arrays.
  static constexpr std::uint32_t kFrameCorners = 3, kFirstFrameCorner = 0u - kFrameCorners;
  static constexpr std::uint32_t kInside = 3;  // in place of a corner
  static constexpr std::uint32_t kNoVertex = kFirstFrameCorner - 1;
  static bool is_frame(std::uint32_t vertex) { return vertex >= kFirstFrameCorner; }
  using VertexPair = std::pair<std::uint32_t, std::uint32_t>;

  void reset_scratch(const PointCircles* circles);
  int orientation(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c);
  int orientation_of(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  int orientation_of_point(std::uint32_t a, std::uint32_t b, const PlanePoint& p);
  int in_circle(const LinkedTriangle& t, const PlanePoint& p, std::uint32_t vertex);
  bool share_circle(const LinkedTriangle& t, std::uint32_t vertex) const;

  // The sides of a triangle's edges on which a point lies: a corner with the point beyond its edge,
  // or kInside; and the edges on whose lines it lies, one bit each, if it is beyond none.
  struct Sides {
    std::uint32_t beyond, on;
  };
  Sides sides(const PlanePoint& p, std::uint32_t t, std::uint32_t from);
  static Location location(std::uint32_t t, std::uint32_t on);
  Location search_all(const PlanePoint& p);

  // The triangle after t, counter-clockwise around a vertex. Precondition: no corner of the frame.
  std::uint32_t after(std::uint32_t vertex, std::uint32_t t) const {
    const LinkedTriangle& w = triangles_[t];
    return w.neighbors[corner_after(w.corner_at(vertex))];
  }
  std::uint32_t& star(std::uint32_t vertex) { return star_[vertex + kFrameCorners]; }
  std::uint32_t add_triangles(std::size_t count);
  void split(std::uint32_t t, std::uint32_t vertex);
  void flip_edge(std::uint32_t t, std::uint32_t corner);
  void legalize_around_new();
  bool should_flip(std::uint32_t t, std::uint32_t corner);

  bool find_edge(std::uint32_t a, std::uint32_t b, Edge& edge) const;
  bool find_edge_at(std::uint32_t a, std::uint32_t b, Edge& edge) const;
  Outcome set_piece(const Edge& edge, std::uint32_t piece);
  Outcome find_crossed(std::uint32_t from, std::uint32_t to);
  Outcome first_crossed(std::uint32_t from, std::uint32_t to, Edge& edge);
  void flip_crossed(std::uint32_t from, std::uint32_t to);
  void legalize_flipped(std::uint32_t from, std::uint32_t to);

  // Absolute values of coordinates in the frame are at most this.
  double largest_ = 0;
  PlaneErrors errors_{};
  const PointCircles* circles_ = nullptr;
  std::vector<PlanePoint> points_;
  std::vector<LinkedTriangle> triangles_;
  std::vector<std::uint32_t> star_;    // by vertex: a triangle at it
  std::vector<std::uint8_t> inside_;   // by triangle
  std::vector<std::uint32_t> stack_;   // scratch memory: triangles to look at
  std::vector<std::uint32_t> visits_;  // by triangle: the last search that came by
  std::vector<Edge> found_;
  std::vector<VertexPair> crossed_, flipped_;  // scratch memory of insert_piece()
  std::uint32_t search_ = 0;                   // number of the last search
  std::uint32_t turn_ = 0;                     // where locate() begins in a triangle
  std::uint64_t exact_tests_ = 0;
};

}  // namespace vdwmesh
