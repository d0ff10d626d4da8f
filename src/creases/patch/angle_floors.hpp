// The floors of angles, for meshes without another bound on them (patch_angles.hpp): which angles
// of a patch's triangles are below their floor, and which pieces of its boundary must be split to
// enlarge them. On the host alone.
//
// Every angle has the floor kFloorOfAngles, but at a corner of the patch where the exact angle
// between the two arcs is less than twice as much: there half of it. In molecules one patch in some
// 5,000 has an angle below its floor. There are three kinds:
//
// - triangles over an arc of less than 1e-3 of the edge length, beside which pieces are not split
//   for quality. The piece at the end of the arc is halved until it is short enough.
// - the triangle in a sharp corner, if its two pieces are not of one length. If pieces of the
//   lengths 1 and r > 1 enclose the angle α, the one opposite to the shorter piece is
//   arctan(sin α / (r - cos α)): at least 5° if r <= cos α + 11.43 sin α, which is 1.24 for
//   α = 1.2° and nearly 1 for still smaller α. Halving does not lead there. So the longer piece is
//   cut where the other one ends. It is if r is at most 2 or hardly more, so that α is less than
//   5.1°, and for such small α what is left of the longer piece is some 11.4 times as long as the
//   distance of the two ends: it is not a new short piece in a wide place.
// - triangles across narrow places. A piece beside them is halved.
#pragma once

#include <cstdint>
#include <optional>

#include "creases/arcs/arc_sampling.hpp"
#include "creases/arcs/patch_boundary.hpp"
#include "creases/arcs/patch_vector.hpp"
#include "creases/arcs/split_limits.hpp"
#include "creases/patch/patch_angles.hpp"
#include "creases/plane/patch_triangles.hpp"

namespace vdwmesh {

// The arcs that a patch's pieces are of. Keeps references.
struct ArcsOfPatch {
  const BoundaryArcs& boundary;
  const ArcSampling& sampling;
  const SplitLimits& limits;
  std::uint32_t ball;  // the patch's
  double radius;       // its ball's
};

class AngleFloors {
 public:
  // `edge_length` is that of the patch, on the unit sphere. Keeps views.
  AngleFloors(const PatchBoundaryView& boundary, const ArcsOfPatch& arcs, double edge_length);

  // These three take an angle for below its floor until it is kFloorMargin above it. So where none
  // is counted there is none in the mesh either, whose coordinates are rounded otherwise. And by
  // the count the mesher decides whether splits for the floors have helped, so it must be that of
  // the angles that find() asks splits for.
  bool has_angle_below(const PatchTriangles& patch) const;
  std::uint64_t count(const PatchTriangles& patch) const;  // of those below
  // Appends a request to split a piece for each angle below its floor, if there is one that may be
  // split: one neither too short nor too straight, on an arc that has not too many.
  void find(const PatchTriangles& patch, PatchVector<PieceSplit>& found) const;

 private:
  // Calls visit(triangle, k) for each angle, at vertex k, below its floor, until it returns true.
  // Returns whether it has.
  template <class Visit>
  bool visit_below(const PatchTriangles& patch, const Visit& visit) const;
  double floor_at(const PatchTriangles& patch, std::uint32_t t, std::uint32_t k) const;
  Vec3d direction_along(std::uint32_t piece, bool from_its_end) const;
  double exact_angle(std::uint32_t leaving, std::uint32_t coming, double flat) const;
  void ask(const LinkedTriangle& t, std::uint32_t k, PatchVector<PieceSplit>& found) const;
  void ask_at_corner(const LinkedTriangle& t, std::uint32_t k, std::uint32_t corner,
                     PatchVector<PieceSplit>& found) const;
  void halve(std::uint32_t piece, PatchVector<PieceSplit>& found) const;
  void cut(std::uint32_t piece, std::uint32_t point, double length,
           PatchVector<PieceSplit>& found) const;
  // Whether it may be split into two parts, the shorter one this fraction of it.
  bool may_split(std::uint32_t piece, double fraction) const;

  PatchBoundaryView boundary_;
  PieceChords chords_;
  ArcsOfPatch arcs_;
  double shortest_;
};

}  // namespace vdwmesh
