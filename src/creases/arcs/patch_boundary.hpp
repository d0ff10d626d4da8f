// The boundary of one patch, as the patch mesher needs it. A patch is the exposed part of one
// sphere. Its boundary consists of the sampled arcs around it, scaled to the unit sphere about the
// centre of the sphere. Also the index that finds the arcs and neighbours of each ball.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/host_device.hpp"
#include "core/order/sorted_rows.hpp"
#include "core/vec3.hpp"
#include "creases/arcs/arc_sampling.hpp"
#include "creases/arcs/patch_vector.hpp"
#include "creases/plane/row_lists.hpp"

namespace vdwmesh {

struct BoundaryArcs;
struct ExposedBoundary;
struct PlacedBalls;
struct Sphere;

// The cap of the patch's sphere that another ball covers: the directions u from the centre with
// axis · u > cosine. Its rim is the circle in which the two spheres meet.
struct CoveredCap {
  Vec3d axis;     // unit, towards the other ball's centre
  double cosine;  // of the cap's angular radius; negative: more than half the sphere
  // Squared straight distance from the rim to the point `axis` of the unit sphere if cosine >= 0,
  // else to the point -axis; that is the nearer of the two. covers() compares with it, because the
  // cosine of a tiny cap rounds to 1, and the cosine of a cap that leaves a tiny part free rounds
  // to -1. The distance keeps its digits in both cases. For a contact it is set to 0; the cap then
  // covers nothing if cosine >= 0, and all but the point -axis if cosine < 0.
  double squared_distance;

  // Whether the cap covers the direction u, a unit vector.
  VDWMESH_HD bool covers(const Vec3d& u) const {
    return cosine >= 0 ? squared_norm(u - axis) < squared_distance
                       : squared_norm(u + axis) > squared_distance;
  }
};

// A chord between two sample points of an arc, directed so that the patch is on its left.
struct BoundaryPiece {
  std::uint32_t from, to;  // indices into PatchBoundary::points
  std::uint32_t neighbor;  // the ball on the other side of the arc, which also names its circle
  ArcPiece source;         // the same piece in the sampling
  // The angle (rad) between the chord and the arc at either end. It is positive if the arc leaves
  // its chord towards the inside of the patch.
  double bulge;
};

// Says that the sphere of `ball` passes through point `point` of PatchBoundary::points.
struct SphereThrough {
  std::uint32_t point, ball;
};

struct PatchBoundary {
  // Unit vectors from the sphere's centre: first the corners in the order of their indices in
  // BoundaryArcs, then arc by arc the sample points between its ends, then what split_pieces() has
  // added.
  PatchVector<Vec3d> points;
  PatchVector<BoundaryPiece> pieces;
  PatchVector<CoveredCap> caps;  // one per edge of the ball in the dual complex
  // All other spheres through corners, if corners were joined; the pieces of this patch alone do
  // not show them. Empty otherwise.
  PatchVector<SphereThrough> through;
};

// The same in memory of somebody else.
struct PatchBoundaryView {
  std::span<const Vec3d> points;
  std::span<const BoundaryPiece> pieces;
  std::span<const CoveredCap> caps;
  std::span<const SphereThrough> through;

  PatchBoundaryView() = default;
  // Not explicit: functions that take a view take a boundary as well.
  PatchBoundaryView(const PatchBoundary& b)
      : points(b.points), pieces(b.pieces), caps(b.caps), through(b.through) {}
};

// For how many points or pieces a boundary gets room at first, if it has so many: most boundaries
// of molecules then keep their arrays through all rounds. To move them costs more than all else in
// a look at a boundary but the insertion of its points.
constexpr std::size_t with_room_for_splits(std::size_t count) { return count + count / 4; }

// What became of a piece that was split: a chain of `parts` pieces. The first one has the number of
// the old piece, the others the numbers first_part, first_part + 1, ... In between are the points
// first_point, first_point + 1, ...
struct SplitChain {
  std::uint32_t piece, parts, first_part, first_point;
};

// The centre of the largest cap, as a unit vector. It serves as the pole of the stereographic
// projection, so it must not lie in the patch. It lies as far from the patch as the rim of its cap
// at least, and of all caps this one has the farthest rim, or all but. Precondition: at least one
// cap is larger than a point.
VDWMESH_HD inline Vec3d buried_pole(const PatchBoundaryView& boundary) {
  // Squared straight distance from the cap's centre `axis` to its rim. For cosine < 0 the cap
  // stores the squared distance to -axis instead; by Pythagoras the two add up to 4.
  const auto squared_reach = [](const CoveredCap& cap) {
    return cap.cosine >= 0 ? cap.squared_distance : 4 - cap.squared_distance;
  };
  double largest = 0;
  for (const CoveredCap& cap : boundary.caps) largest = std::max(largest, squared_reach(cap));
  // Of caps that are equal but for rounding, the first one. Rounding must not choose.
  constexpr double kTie = 1e-6;
  std::size_t i = 0;
  while (!(squared_reach(boundary.caps[i]) >= (1 - kTie) * largest)) ++i;
  return boundary.caps[i].axis;
}

// An order, as indices, for inserting the points of a boundary into a Delaunay triangulation. If
// there are few points, they keep their order. With many points this would be slow: the points of a
// circle come one after the other, and each one would change most of the edges that exist. So the
// order is hierarchical. It begins with a coarse subset, and each following round halves the
// spacing of the points inserted so far.
std::vector<std::uint32_t> boundary_order(std::size_t count);
// Fewer points than this keep their order.
inline constexpr std::uint32_t kReorderedPoints = 1024;

// The arcs and neighbours of each ball, and the balls at each corner, as compressed sparse rows.
class PatchIndex {
 public:
  // `exposed` must outlive the index.
  PatchIndex(const PlacedBalls& balls, const ExposedBoundary& exposed,
             const BoundaryArcs& boundary);

  // The arcs around a ball's patch, as indices into BoundaryArcs::arcs.
  std::span<const std::uint32_t> arcs(std::uint32_t ball) const;
  // The balls at the other ends of a ball's edges in the dual complex.
  std::span<const std::uint32_t> neighbors(std::uint32_t ball) const;
  // The balls of all arcs that end in a corner, with repetitions. If no corner was joined, the list
  // is empty for every corner: each then lies on three spheres, which the arcs there show.
  std::span<const std::uint32_t> balls_at(std::uint32_t corner) const;

 private:
  SortedRows<std::uint32_t> arcs_;
  const ExposedBoundary& exposed_;
  RowLists balls_;
};

// An arc as the patch on one of its sides sees it.
struct RimArc {
  std::uint32_t arc;
  std::uint32_t circle;  // its name, which becomes BoundaryPiece::neighbor
  double cosine;         // of the cap behind its circle
};

// Replaces the points and pieces of `out` by those of the patch on the sphere `s` that is on one
// side of the given arcs: `side` is its name in BoundaryArc::balls. First come the corners,
// ascending, then arc by arc the points between its ends.
void gather_pieces(const BoundaryArcs& boundary, const ArcSampling& sampling, const Sphere& s,
                   std::uint32_t side, std::span<const RimArc> arcs, PatchBoundary& out);
// The cap of the sphere `s` that the ball `neighbor` covers.
CoveredCap covered_cap(const BoundaryArcs& boundary, const Sphere& s, const Sphere& neighbor);
// Replaces `out` by the boundary of one ball's patch. A sphere without arcs gets no points and no
// pieces, but all its caps.
void gather_boundary(const PlacedBalls& balls, const BoundaryArcs& boundary,
                     const ArcSampling& sampling, const PatchIndex& index, std::uint32_t ball,
                     PatchBoundary& out);
// Brings a boundary, that of the patch `side` on the sphere `s`, up to date after
// ArcSampling::split(splits): splits its pieces in the same way, with the new points and pieces at
// the end, and appends to `chains` how. So points and pieces keep their numbers. `sampling` is as
// after the split; the boundary must be as before.
void split_pieces(const BoundaryArcs& boundary, const ArcSampling& sampling, const Sphere& s,
                  std::uint32_t side, std::span<const PieceSplit> splits, PatchBoundary& out,
                  PatchVector<SplitChain>& chains);
// Writes the sources of the points of an up-to-date boundary, that of the patch `side`.
void point_sources(const BoundaryArcs& boundary, const ArcSampling& sampling, std::uint32_t side,
                   const PatchBoundary& points, std::span<PointSource> out);
// Replaces `out` by the mesh vertices of the points that gather_boundary() lists, in the same
// order.
void boundary_vertices(const BoundaryArcs& boundary, const ArcSampling& sampling,
                       const PatchIndex& index, std::uint32_t ball,
                       std::vector<std::uint32_t>& out);

}  // namespace vdwmesh
