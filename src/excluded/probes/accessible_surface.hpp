// The accessible surface, prepared as the input of the excluded one: arcs on which a probe rolls,
// probes at its corners, pieces of contact patches, and connected components.
//
// Everything combinatorial comes from the dual complex of the grown balls. Corners that are one
// point are gathered here: two corners at the ends of a dropped arc belong to one probe.
// Lengths are scaled as in the triangulation, and positions are relative to `origin`.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "complex/boundary/boundary_shapes.hpp"
#include "excluded/patches/patch_sides.hpp"

namespace vdwmesh::excluded {

// Arcs shorter than this (scaled: the largest grown ball has a radius from 1/2 to 1) are dropped.
// Where several corners are as near, drop_short_arcs() tells them apart by wide numbers instead.
// Coordinates some radii from the origin are wrong by about 1e-14, and those of a corner may be
// 1000 times as wrong. The area of what is dropped shows in no digit of a double.
inline constexpr double kNoLength = 1e-11;

// An exposed arc as an element of the surface. The saddle lies along it. A ring is a whole circle
// and has no probes.
struct RolledArc : ArcShape {
  std::uint32_t edge;                    // of the complex
  std::array<std::uint32_t, 2> ball;     // a, b
  std::array<std::uint32_t, 2> probe;    // at start and end; kNoIndex: a ring
  std::array<std::uint32_t, 2> beyond;   // the circle's arcs before start and after end, or itself
  std::array<std::uint32_t, 2> contact;  // pieces of contact patches on a and b
  Vec3d center;                          // of the circle
  bool dropped;  // shorter than kNoLength, between corners of one probe; ArcShape::radial is 0

  bool is_ring() const { return probe[0] == kNoIndex; }
};

// An arc that ends at a probe, and which of its ends is there.
struct ProbeSide {
  std::uint32_t arc;
  ArcEnd end;
};

// The probe at a corner, or at several gathered ones.
struct Probe {
  Vec3d center;
  CornerIndex corner;                         // the lowest of its corners
  std::uint32_t sides_begin, side_count;      // see sides_of()
  std::uint32_t corners_begin, corner_count;  // see corners_of()
  std::uint32_t component;
  double solid_angle;  // of the uncut concave patch
  bool low;            // nearer than the probe's radius to the plane of three of its atoms
};

// A connected piece of the exposed part of a grown ball.
struct ContactPiece {
  std::uint32_t ball, component;
  std::uint32_t loops;  // boundary loops with an arc that is not dropped
  bool point;           // has a boundary, and all arcs of it are dropped
  double solid_angle;
  Vec3d vector;  // integral of the outward normal over the piece of the unit sphere
};

struct ComponentMeasures {
  double area, volume;  // scaled; the volume is negative inside a cavity
  Vec3d home;           // centre of one of its balls, in the triangulation: see place()
};

// The flux ∫ q · n dA / 3 of the position through a part of a sphere. `vector` is ∫ n dω.
inline double flux_through(double radius, const Vec3d& center, double solid_angle,
                           const Vec3d& vector) {
  return radius * radius * (dot(center, vector) + radius * solid_angle) / 3;
}

struct ContactLoops;

class AccessibleSurface {
 public:
  AccessibleSurface(const PowerTriangulation& triangulation, const DualComplex& complex,
                    const BoundaryShapes& shapes, double probe_radius, double no_length,
                    Monitor* monitor);

  double probe_radius;
  Vec3d origin;  // the middle of the box around the balls' centres
  std::vector<RolledArc> arcs;
  std::vector<Probe> probes;
  std::vector<ProbeSide> sides;      // by probe
  std::vector<CornerIndex> corners;  // by probe
  std::vector<ContactPiece> contacts;
  std::vector<ComponentMeasures> components;
  std::uint64_t gathered_corners = 0, dropped_arcs = 0;

  // For each component whether it bounds the outer region of space, and not a cavity or something
  // inside of one.
  std::vector<std::uint8_t> outer_components() const;

  std::span<const ProbeSide> sides_of(const Probe& p) const {
    return std::span(sides).subspan(p.sides_begin, p.side_count);
  }
  std::span<const CornerIndex> corners_of(const Probe& p) const {
    return std::span(corners).subspan(p.corners_begin, p.corner_count);
  }
  const DualTriangle& triangle_of(CornerIndex corner) const {
    return complex_.triangles[corner / 2];  // see CornerIndex
  }
  const BoundaryShapes& shapes() const { return shapes_; }
  const DualComplex& complex() const { return complex_; }
  const PowerTriangulation& triangulation() const { return triangulation_; }
  // A ball's centre, relative to the origin.
  Vec3d center(std::uint32_t ball) const { return place(ball, origin); }

  std::uint32_t component_of(const RolledArc& arc) const {
    return contacts[arc.contact[0]].component;
  }
  // Whether an arc has a length and is of a component that is included.
  bool counts(const RolledArc& arc, std::span<const std::uint8_t> included) const {
    return !arc.dropped && included[component_of(arc)] != 0;
  }

  // Places relative to a point near by, which keeps the digits that coordinates from a far origin
  // lose: centres of a ball, an arc's circle and a probe.
  Vec3d place(std::uint32_t ball, const Vec3d& home) const {
    return triangulation_.balls[ball].center - home;
  }
  Vec3d place(const RolledArc& arc, const Vec3d& home) const {
    return place(arc.ball[0], home) + arc.height[0] * arc.axis;
  }
  Vec3d place(const Probe& probe, const Vec3d& home) const {
    return place(triangle_of(probe.corner).vertices[0], home) + from_first(probe.corner);
  }
  // The vector from one probe to another, or to a ball.
  Vec3d between(const Probe& from, const Probe& to) const {
    const Vec3d& home = triangulation_.balls[triangle_of(from.corner).vertices[0]].center;
    return place(to, home) - from_first(from.corner);
  }
  Vec3d between(const Probe& from, std::uint32_t ball) const {
    const Vec3d& home = triangulation_.balls[triangle_of(from.corner).vertices[0]].center;
    return place(ball, home) - from_first(from.corner);
  }
  // Numbers the boundary loops of the exposed parts of balls by elements, 2 × arc + side, and
  // returns how many there are.
  std::uint32_t number_loops(Buffer<std::uint32_t>& loop_of) const;
  // An element of the loop of vertex k's ball through a corner of its triangle.
  std::uint32_t element_at(CornerIndex corner, std::size_t k) const;
  // A corner's place, relative to the origin.
  Vec3d corner_point(CornerIndex corner) const {
    return center(triangle_of(corner).vertices[0]) + from_first(corner);
  }

 private:
  // A corner relative to the first ball of its triangle.
  const Vec3d& from_first(CornerIndex corner) const {
    const CommonPoints& points = shapes_.corners(corner / 2);
    return corner % 2 == 0 ? points.above : points.below;
  }
  // The arc at a corner on an edge of the complex, which is one of the corner's triangle.
  std::uint32_t& arc_at(CornerIndex corner, std::uint32_t edge);
  void place_arcs(double no_length);
  void gather_corners();
  bool is_low(CornerIndex corner) const;
  void list_sides();
  void link_circles();
  void find_pieces();
  // For each loop the lowest number of a loop of the same piece.
  std::vector<std::uint32_t> lowest_loops(const ContactLoops& table) const;
  void measure_pieces();
  void find_components();

  const PowerTriangulation& triangulation_;
  const DualComplex& complex_;
  const BoundaryShapes& shapes_;
  std::vector<ExposedArc> exposed_;  // by arc
  // By corner: the arc on each edge, in the order of DualTriangle::edges.
  std::vector<std::array<std::uint32_t, 3>> arc_at_;
  std::vector<std::uint32_t> probe_at_;  // by corner
};

}  // namespace vdwmesh::excluded
