// The concave patch of a probe: its unit sphere less caps.
//
// The patch is the polygon of great circles through the points of contact with the atoms, one side
// for each arc of the accessible surface that ends at the probe, less the caps that other probes
// cover. Known by construction, and not found by intersecting numbers:
// - a cap meets a side only if the side's saddle is a spindle, and then in the side's cusps;
// - of the caps of probes on the circle of such a side only that of the nearest one beyond the gap
//   in the circle matters, because the bisecting planes of all of them contain the circle's axis.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "excluded/patches/cap_face.hpp"
#include "excluded/patches/saddle.hpp"
#include "excluded/probes/accessible_surface.hpp"
#include "excluded/probes/low_probes.hpp"

namespace vdwmesh::excluded {

// A side of the polygon, directed so that the patch is on its left seen from outside the sphere.
struct PatchSide {
  std::uint32_t arc;
  ArcEnd end;                         // of the arc, at which the probe is
  std::array<std::uint32_t, 2> atom;  // from, to
  Vec3d inward;                       // unit normal of the side's plane
  std::array<Vec3d, 2> contact;       // unit vectors to the atoms
  std::array<Vec3d, 2> cusp;          // of a spindle: unit vectors to the cusps near the atoms
  std::array<double, 2> angle;        // of the side up to its radical plane, or up to the cusps
  bool spindle;
  std::uint32_t gap;  // of a spindle: the cap that ends at the cusps
  double turning;     // exterior angle where the side ends
};

// Covers the points w of the unit sphere with axis · w > cosine. 0 < cosine < 1.
struct PatchCap {
  Vec3d axis;
  double cosine;
  std::uint32_t probe;
};

// Circles are numbered: first the caps, then the sides. A segment of the boundary runs along one
// circle, clockwise about a cap's axis, from the circle before to the next one on the same loop.
// Segments of whole circles have kNoIndex in place of both.
struct PatchSegment {
  std::uint32_t before, circle, next;
  std::uint32_t piece;
  double angle;
  Vec3d from, to;
  double turning;  // exterior angle at `to`; 0 on whole circles
};

// The different radii of the probes, which follow from their numbers, made a decision with a margin
// below this. A surface with other numbers, as of some of the atoms, may decide otherwise.
inline constexpr double kBrokenTie = 1e-45;

// A connected piece of the patch.
struct PatchPiece {
  double solid_angle;
  Vec3d vector;  // ∫ w dω
  std::uint32_t loops;
};

struct ConcavePatch {
  std::uint32_t probe;
  std::vector<PatchSide> sides;
  std::vector<PatchCap> caps;
  std::vector<PatchSegment> segments;
  std::vector<PatchPiece> pieces;
  bool extended = false;  // decided by wide numbers
  bool tie = false;       // a decision was a tie even so
  double margin = 1;      // of the closest decision
  bool certified = true;  // the boundary closes
};

// The directed sides of a probe's polygon, in no particular order, without `gap`.
std::vector<PatchSide> patch_sides(const AccessibleSurface& surface, const Probe& probe);

// ∫ w dω over the uncut patch.
Vec3d polygon_vector(const std::vector<PatchSide>& sides);

// The patch of a probe that no other one cuts.
ConcavePatch whole_patch(const AccessibleSurface& surface, std::uint32_t probe);

// Sum over the caps of cosine × area of the cap's flat face, in the cone of the probe over its
// patch and in the further half-spaces: three times the volume of the cones over the faces.
double flat_faces(const ConcavePatch& patch, std::span<const HalfSpace> within);

// The patch of a low probe. `included` says of which components of the accessible surface the
// probes are.
ConcavePatch concave_patch(const AccessibleSurface& surface, const LowProbes& low,
                           std::span<const std::uint8_t> included, std::uint32_t probe);

// The patches of all low probes of these components, by probe, ascending; made on all cores.
std::vector<ConcavePatch> cut_patches(const AccessibleSurface& surface,
                                      std::span<const std::uint8_t> included, Monitor* monitor);

}  // namespace vdwmesh::excluded
