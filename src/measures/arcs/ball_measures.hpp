// Area of the exposed patch, volume of the cut ball and Euler characteristic, from a power cell.
//
// BallMeasurer measures ball ∩ cell, the cut ball. A vertex of the cell lies inside the ball or
// outside. An edge meets the ball in a segment or not at all; a segment ends at vertices or, on the
// sphere, in corners of the patch. A face meets the ball in a region bounded by segments and arcs,
// in a whole disk, or not at all.
//
// Let t be the cosine of a cap, phi the exposed angle of its circle, F the area of its face.
//   area   = 2 pi chi + sum phi t - sum turning angles   Gauss–Bonnet on the exposed patch
//   volume = (area + sum t F) / 3                        divergence theorem about the centre
// chi is the Euler characteristic of the patch. The surface of the cut ball is a topological
// sphere, so the number of its inner vertices, minus segments, plus faces, plus chi is 2. Corners
// and arcs do not appear, because there are as many of the one as of the other.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "measures/arcs/power_cell.hpp"

namespace vdwmesh::arcs {

struct BallMeasures {
  double area = 0, volume = 0;            // of the exposed patch; of the cut ball. The radius is 1.
  std::uint32_t doubts = 0;               // Doubt bits; 0: no check failed
  std::int32_t euler_characteristic = 0;  // of the exposed patch
  std::uint32_t corners = 0;              // of the exposed patch
};

struct ComplexNumber {
  double re, im;
};

inline ComplexNumber operator*(const ComplexNumber& a, const ComplexNumber& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

// A sum of angles between 0 and pi, kept as a product of complex numbers and the number of whole
// turns.
class AngleSum {
 public:
  // Adds the argument of a number, which is in [0, pi]. Precondition: im >= 0.
  void add(const ComplexNumber& factor);
  // The sum is 2 pi turns() and the argument of product(), which is in [0, 2 pi).
  double turns() const { return turns_; }
  const ComplexNumber& product() const { return product_; }

 private:
  ComplexNumber product_{1, 0};
  std::uint32_t turns_ = 0;
};

// Measures one ball after another and keeps its memory for the next one.
class BallMeasurer {
 public:
  // The measures of ball ∩ cell. The doubts about the cell are passed on with those found here.
  BallMeasures measure(const CellView& cell);

  // What a plane of the cell has in common with the ball.
  struct CellFace {
    bool crossed = false;      // a segment bounds it
    bool whole = false;        // it is the whole disk
    std::uint32_t ends = 0;    // corners on its circle
    std::int32_t balance = 0;  // ends of arcs less starts, counter-clockwise about the axis
    Vec3d reference{};         // from the disk's centre to its first corner
    ComplexNumber arc{1, 0};   // its argument is the exposed angle from the reference, modulo 2 pi
    double angle = 0;          // exposed, of the circle

    bool meets_ball() const { return crossed || ends > 0 || whole; }
  };
  // A corner of the exposed patch, on an edge of the cell. Direction 1: from the edge's middle it
  // lies along axis a × axis b of the edge's planes; an arc of circle a starts there and one of b
  // ends. -1: the other way round.
  struct PatchCorner {
    EdgeEnd edge;
    std::int32_t direction;
  };
  struct EdgeIncidence {
    std::uint32_t from, to, a, b;  // its vertices and its planes
  };
  static EdgeIncidence edge_of(const CellView& cell, EdgeEnd end);

  // Of the last ball. Without planes or an exposed patch it has no faces; the rest means nothing.
  bool has_faces() const { return has_faces_; }
  // Whether the cell lies inside the ball, so that all of its faces do and nothing is exposed.
  bool is_closed() const { return is_closed_; }
  std::span<const EdgeEnd> inner_edges() const { return edges(2); }  // in the ball from end to end
  // Corners edge by edge: an edge has one, or two of which the first has direction 1.
  std::span<const PatchCorner> corners() const { return {patch_corners_.data(), corners_}; }
  std::span<const Position> corner_places() const { return {corner_places_.data(), corners_}; }
  std::span<const std::uint32_t> planes() const { return {planes_.data(), face_count_}; }
  const CellFace& face(std::uint32_t plane) const { return faces_[plane]; }

 private:
  // An edge of the cell: its planes in the order in which the edge runs against the cross product
  // of their axes.
  struct PolytopeEdge {
    std::uint32_t a, b;
    Vec3d from, to;
    EdgeEnd end;
  };

  // The point of a plane that is nearest to the centre, in the order z, x, y of turned_cross(). The
  // fourth number has no meaning.
  struct alignas(32) Foot {
    double at[4];
  };

  void find_edges(const CellView& cell);
  void find_feet(const CellView& cell);
  std::span<const EdgeEnd> edges(std::size_t ends_inside) const {
    return {edges_[ends_inside].data(), edge_count_[ends_inside]};
  }
  bool find_inside(const CellView& cell);
  bool find_faces(const CellView& cell);
  BallMeasures measure_polytope(const CellView& cell);
  BallMeasures measure_patch(const CellView& cell);
  void add_inner_edges(const CellView& cell);
  void add_crossing_edges(const CellView& cell);
  void add_outer_edges(const CellView& cell);
  void add_edge(const CellView& cell, const PolytopeEdge& edge, int ends_inside, bool from_inside);
  void add_segment(const Cap& a, const Cap& b, const Vec3d& from, const Vec3d& to);
  void add_corner(const PolytopeEdge& edge, const Cap& a, const Cap& b, const Vec3d& corner,
                  int direction);
  void add_arc_end(CellFace& face, const Cap& cap, const Vec3d& corner, int direction);
  bool is_whole_disk(const CellView& cell, std::uint32_t plane);
  void find_angles();
  BallMeasures sum_up(const CellView& cell);

  std::vector<double> height_;         // by vertex: squared distance from the centre, less 1
  std::vector<CellFace> faces_;        // by plane; valid for planes_, if something is exposed
  std::vector<std::uint64_t> stamps_;  // by plane: the last ball in which it had a face
  std::vector<std::uint32_t> planes_;  // the planes that have a face, then unused elements
  std::uint32_t face_count_ = 0;
  // The edges by how many of their ends are inside the ball (0, 1 or 2). An edge is listed once, by
  // one of its ends.
  std::array<std::vector<EdgeEnd>, 3> edges_;
  std::array<std::size_t, 3> edge_count_{};
  std::vector<Foot> feet_;  // by plane; valid for planes_
  std::vector<PatchCorner> patch_corners_;
  std::vector<Position> corner_places_;  // by corner
  bool has_faces_ = false, is_closed_ = false;
  std::uint64_t stamp_ = 0;
  std::uint32_t inside_ = 0, doubts_ = 0, segments_ = 0, corners_ = 0;
  double worst_ = 1;  // the largest condition number of a corner's angle
  // Sum t 2 F, until sum_up() without the sectors between arcs and disk centre.
  double pyramid_ = 0;
  Vec3d open_{};  // twice the vector area of the surface of the cut ball
  AngleSum turning_;
  std::vector<double> angles_, re_, im_;  // find_angles()
};

}  // namespace vdwmesh::arcs

#include "measures/arcs/ball_measures_sum.hpp"
