// The arcs around the exposed part of one sphere, as the patch mesher needs them: on the unit
// sphere about its centre.
#pragma once

#include <cstdint>
#include <vector>

#include "arrangement/mesher/arc_sampling.hpp"

namespace vdwmesh {

// What another ball covers of the sphere: directions u with axis · u > cosine.
struct CoveredCap {
  Vec3d axis;
  double cosine;
  // From the rim to the nearer of axis and -axis: the cosine of a tiny cap, or of one that leaves
  // little, has no digits left to tell them by. 0 for a contact, which covers nothing (or all).
  double squared_distance;

  bool covers(const Vec3d& u) const {
    return cosine >= 0 ? squared_norm(u - axis) < squared_distance
                       : squared_norm(u + axis) > squared_distance;
  }
};

// A piece of an arc, with the patch on its left.
struct BoundaryPiece {
  std::uint32_t from, to;  // points
  std::uint32_t neighbor;  // the ball on the other side
  ArcPiece source;
  double bulge;  // rad: by which the arc turns into the patch from its chord, at either end
};

// Another sphere through a point of the boundary.
struct SphereThrough {
  std::uint32_t point, ball;
};

// Points: corners first, then those between, arc by arc.
struct PatchBoundary {
  std::vector<Vec3d> points;
  std::vector<BoundaryPiece> pieces;
  std::vector<CoveredCap> caps;
  std::vector<SphereThrough> through;  // beside those that the pieces tell of
};

// The centre of the largest cap, which is buried and as far from the patch as can be.
// Precondition: a cap that is more than a point.
Vec3d buried_pole(const PatchBoundary& boundary);

// The points that are farther from every cap than its margin, the cosine of an angle from its axis.
std::vector<Vec3d> clear_points(const std::vector<CoveredCap>& caps,
                                const std::vector<double>& margins,
                                const std::vector<Vec3d>& points);

// An order to insert the points in a Delaunay triangulation. Few come as they are; each next one on
// a circle would turn most of the edges there are, so of many every second of those left, over and
// over, begins with the coarsest.
std::vector<std::uint32_t> insertion_order(const PatchBoundary& boundary);

// The circles that each point of a boundary lies on, as the balls they are shared with (which at a
// joined corner may touch the sphere's circle in that point alone).
class PointCircles {
 public:
  explicit PointCircles(const PatchBoundary& boundary);
  // Whether both points, of the boundary or not, lie on one circle.
  bool share(std::uint32_t a, std::uint32_t b) const;
  bool on(std::uint32_t point, std::uint32_t neighbor) const;

 private:
  std::span<const std::uint32_t> of(std::uint32_t point) const;
  std::vector<std::uint32_t> first_, neighbors_;
};

// The arcs and neighbours of each ball.
class PatchIndex {
 public:
  PatchIndex(const PowerTriangulation& triangulation, const DualComplex& complex,
             const BoundaryArcs& boundary);

  std::span<const std::uint32_t> arcs(std::uint32_t ball) const;
  std::span<const std::uint32_t> neighbors(std::uint32_t ball) const;
  // The balls at a corner, some twice; none where all corners are plain ones of three arcs.
  std::span<const std::uint32_t> balls_at(std::uint32_t corner) const;

 private:
  std::vector<std::uint32_t> first_arc_, arcs_, first_neighbor_, neighbors_, first_ball_, balls_;
};

// Points of a ball in the numbering of the sampling's vertices: local corner or point -> vertex.
// Both are empty for a sphere without arcs.
void gather_boundary(const PowerTriangulation& triangulation, const BoundaryArcs& boundary,
                     const ArcSampling& sampling, const PatchIndex& index, std::uint32_t ball,
                     PatchBoundary& out);
void boundary_vertices(const BoundaryArcs& boundary, const ArcSampling& sampling,
                       const PatchIndex& index, std::uint32_t ball,
                       std::vector<std::uint32_t>& out);

}  // namespace vdwmesh
