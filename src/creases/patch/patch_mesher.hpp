// Meshes a patch, the exposed part of one sphere, between given boundary points, or a whole sphere.
//
// The sphere is projected stereographically from a point that another ball covers. The patch is
// triangulated in the plane with the pieces of its boundary, chords of arcs, as constraints
// (PlaneTriangulation). Circles stay circles, so the triangulation is Delaunay on the sphere as
// well. Bad triangles are removed by inserting their circumcentres (Chew 1993, "Guaranteed-quality
// mesh generation for curved surfaces").
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "creases/arcs/cap_margins.hpp"
#include "creases/arcs/patch_boundary.hpp"
#include "creases/patch/angle_floors.hpp"
#include "creases/patch/patch_angles.hpp"
#include "creases/patch/patch_quality.hpp"
#include "creases/patch/patch_work.hpp"

namespace vdwmesh {

class Monitor;

struct PatchOptions {
  double edge_length;  // wanted, as a fraction of the sphere's radius
  // Whether triangles must be well shaped or only valid, and whether the patch or only its boundary
  // is triangulated (patch_work.hpp).
  Demand demand = Demand::quality;
  PatchStage stage = PatchStage::triangles;
  Monitor* monitor = nullptr;  // asked now and then whether to stop
  // The cosine of the widest angle under which an inserted point may see a piece, a chord of the
  // boundary. A point that sees it under a wider angle would make a flat triangle with it.
  double widest_view = kWidestView;
  // The least angle that triangles shall have, rad; 0: no bound. With Demand::quality pieces are
  // split for it, unless an arc has so many pieces that this has to end.
  double min_angle = 0;
  bool splits_for_angles = true;
  // If not null, PatchMesh says how many angles are below their floors; and if `raises_angles`, the
  // patch is smoothed more often and pieces are split so that none is (angle_floors.hpp).
  const ArcsOfPatch* arcs = nullptr;
  bool raises_angles = false;
  // Of the patch, in squares of the radius. With Demand::quality and PatchStage::boundary pieces
  // are split so that the mesh comes near to it (patch_area.hpp). 0: not known, no splits for it.
  double area = 0;
};

// The outcome: either triangles, or requests to split pieces, after which the patch must be meshed
// again. Vertices of triangles are numbered: first the points of the boundary, then the interior
// points. A run of stage `boundary` returns requests only, and nothing if no piece must be split.
struct PatchMesh {
  PatchVector<Vec3d> interior;                          // unit vectors from the sphere's centre
  PatchVector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from outside
  PatchVector<PieceSplit> splits;                       // requests, each piece once
  std::uint64_t exact_tests = 0;  // tests that double precision did not decide
  SmallAngles below = {};         // triangles below PatchOptions::min_angle
  std::uint64_t below_floor = 0;  // angles; only looked for if there are PatchOptions::arcs
  // Of the points of the boundary. mesh_patch() leaves it empty; UnionMesher fills it.
  PatchVector<PointSource> sources = {};
};

// Points spread evenly over the unit sphere, from which mesh_patch() takes interior points of a
// patch. They are those of mesh_sphere(), in another order. Patches of a molecule have few
// different edge lengths, so the points for some of them are cached. Where the edge is short beside
// the sphere only those near the patch are made, so that memory and time are those of the patch.
class SpherePoints {
 public:
  // The whole sphere's points are made up to so many parts of an edge.
  static constexpr std::uint32_t kMostPartsOfWhole = 64;
  // How many parts an edge of the icosahedron is divided into. The points follow from it.
  static std::uint32_t parts(double edge_length);
  // Both are valid until the next call. With margins: those of the same points, in the same order,
  // that may be clear of them.
  const std::vector<Vec3d>& points(double edge_length);
  const std::vector<Vec3d>& points(double edge_length, const CapMargins<GrowingMemory>& margins);

 private:
  // By the number of parts of an edge, modulo 8. Of several numbers that fall into one element, it
  // keeps it and the points for the one asked for last.
  std::array<std::pair<std::uint32_t, std::vector<Vec3d>>, 8> kept_;
  std::vector<Vec3d> some_;
};

// A patch between two rounds of meshing: its boundary, and the triangulation of the boundary in the
// plane if the last round could make one. `chains` are the pieces that were split since then. Only
// they have to be inserted in the next round.
struct PatchProgress {
  PatchBoundary boundary;
  PatchVector<SplitChain> chains;
  PlaneTriangulation::State plane;
  bool is_triangulated = false;

  static void* operator new(std::size_t bytes) { return take_patch_memory(bytes); }
  static void operator delete(void* memory) noexcept { give_patch_memory(memory); }
};

// Memory for meshing one patch at a time, kept for the next one.
struct PatchScratch : PatchWork<GrowingMemory> {
  SpherePoints lattice;  // candidates for the interior points of a patch
  std::vector<PlanePoint> plane_points;
  bool plane_is_swapped = false;  // `plane` works in the arrays of the progress
};

// Meshes a patch. Every triangle of the result faces outwards. No edge joins two points of one
// circle unless it is a piece of the boundary, so triangles of different spheres meet only along
// pieces and at corners (docs/exact_mesh.md says why).
//
// `progress` needs a boundary and may come from an earlier round; it is brought up to date for the
// next one. Vertices of triangles are numbered as the points of this boundary.
//
// Precondition: at least one piece, and one cap (the part of the sphere that another ball covers,
// patch_boundary.hpp) that is more than a point, since the projection starts in a cap. Throws
// CoincidentPoints (flat_boundary.hpp), Cancelled.
PatchMesh mesh_patch(PatchProgress& progress, const PatchOptions& options, PatchScratch& scratch);
// Makes room for the triangulation of so many points of a boundary, and for later splits.
void make_room_for_splits(std::size_t points, PlaneTriangulation::State& plane);
// Sorts requests by descending piece, as PatchMesh has them, and keeps one for each piece: that
// with the most halvings, of these that with the largest `cut`.
void sort_requests(PatchVector<PieceSplit>& splits);

// Meshes a whole sphere: a subdivided icosahedron. All points are interior points. The edge length
// is a fraction of the radius.
PatchMesh mesh_sphere(double edge_length);

}  // namespace vdwmesh
