// The boundary of one patch, as the patch mesher needs it: the sampled arcs around the exposed part
// of one sphere, moved to the unit sphere about its centre. Also the index that finds the arcs and
// neighbours of each ball.
#pragma once

#include <cstdint>
#include <vector>

#include "arrangement/mesher/arc_sampling.hpp"

namespace vdwmesh {

// The cap that another ball covers: the directions u with axis · u > cosine.
struct CoveredCap {
  Vec3d axis;     // unit, towards the other ball's centre
  double cosine;  // of the cap's angular radius; negative: more than half the sphere
  // Squared distance from the rim to the nearer one of axis and -axis. It decides what the cap
  // covers, because the cosine of a tiny cap rounds to 1, and the cosine of a cap that leaves a
  // tiny part free rounds to -1. The distance keeps its digits in both cases. It is 0 for a
  // contact: this covers nothing if cosine >= 0, and all but -axis if cosine < 0.
  double squared_distance;

  bool covers(const Vec3d& u) const {
    return cosine >= 0 ? squared_norm(u - axis) < squared_distance
                       : squared_norm(u + axis) > squared_distance;
  }
};

// A chord between two sample points of an arc, directed so that the patch is on its left.
struct BoundaryPiece {
  std::uint32_t from, to;  // indices into PatchBoundary::points
  std::uint32_t neighbor;  // the ball on the other side, which also names the circle
  ArcPiece source;         // the same piece in the sampling
  // The angle (rad) between the chord and the arc at either end. It is positive if the arc leaves
  // its chord towards the inside of the patch.
  double bulge;
};

// States that the sphere of `ball` passes through a point of the boundary.
struct SphereThrough {
  std::uint32_t point, ball;
};

// The points are directions from the sphere's centre: first the corners in ascending order, then
// arc by arc the points between its ends.
struct PatchBoundary {
  std::vector<Vec3d> points;
  std::vector<BoundaryPiece> pieces;
  std::vector<CoveredCap> caps;  // one per neighbour in the dual complex
  // Spheres through joined corners, which the pieces alone do not show.
  std::vector<SphereThrough> through;
};

// The centre of the largest cap, as a direction. Of all centres of caps it is the farthest from its
// own rim, and so it lies well away from the patch. Precondition: at least one cap is larger than a
// point.
Vec3d buried_pole(const PatchBoundary& boundary);

// The points outside all enlarged caps. margins[i] is the cosine of the angular radius of cap i
// after its enlargement; a value below -1 admits no point at all.
std::vector<Vec3d> clear_points(const std::vector<CoveredCap>& caps,
                                const std::vector<double>& margins,
                                const std::vector<Vec3d>& points);

// An order for inserting the points into a Delaunay triangulation. Few points stay in their own
// order. With many points this would be slow: each next point on a circle would change most of the
// edges that exist. So the order is hierarchical. It begins with a coarse subset, and each
// following round halves the spacing of the points inserted so far.
std::vector<std::uint32_t> insertion_order(const PatchBoundary& boundary);

// The circles that pass through each point of a boundary. A circle of the patch's sphere is named
// by the ball that shares it. At a joined corner, a ball counts also if it only touches the sphere
// in that point.
class PointCircles {
 public:
  explicit PointCircles(const PatchBoundary& boundary);
  // Whether both points lie on one circle. Interior points, which are numbered after the points of
  // the boundary, lie on none.
  bool share(std::uint32_t a, std::uint32_t b) const;
  // Whether the circle shared with `neighbor` passes through the point.
  bool on(std::uint32_t point, std::uint32_t neighbor) const;

 private:
  // The circles of one point, possibly with repetitions.
  std::span<const std::uint32_t> of(std::uint32_t point) const;
  // Compressed sparse rows: circles of point p at first_[p] .. first_[p + 1] - 1.
  std::vector<std::uint32_t> first_, neighbors_;
};

// The arcs and neighbours of each ball, and the balls at each corner, as compressed sparse rows.
class PatchIndex {
 public:
  PatchIndex(const PowerTriangulation& triangulation, const DualComplex& complex,
             const BoundaryArcs& boundary);

  // The arcs around a ball's patch.
  std::span<const std::uint32_t> arcs(std::uint32_t ball) const;
  // The balls at the other ends of a ball's edges in the dual complex.
  std::span<const std::uint32_t> neighbors(std::uint32_t ball) const;
  // The balls of all arcs that end in a corner, with repetitions. If no corner was joined, the list
  // is empty for every corner: each then lies on three spheres, which the arcs there show.
  std::span<const std::uint32_t> balls_at(std::uint32_t corner) const;

 private:
  std::vector<std::uint32_t> first_arc_, arcs_, first_neighbor_, neighbors_, first_ball_, balls_;
};

// Collects the boundary of one ball's patch into `out`. A sphere without arcs gets no points and no
// pieces; its caps are collected all the same.
void gather_boundary(const PowerTriangulation& triangulation, const BoundaryArcs& boundary,
                     const ArcSampling& sampling, const PatchIndex& index, std::uint32_t ball,
                     PatchBoundary& out);
// The mesh vertex of each point that gather_boundary() lists, in the same order.
void boundary_vertices(const BoundaryArcs& boundary, const ArcSampling& sampling,
                       const PatchIndex& index, std::uint32_t ball,
                       std::vector<std::uint32_t>& out);

}  // namespace vdwmesh
