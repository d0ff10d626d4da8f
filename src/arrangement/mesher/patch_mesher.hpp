// Triangles of the exposed part of one sphere, between given boundary points.
//
// The sphere is projected stereographically from a buried point and triangulated in the plane with
// the boundary as constraints (CGAL, exact predicates). Circles stay circles, so Delaunay there is
// Delaunay on the sphere (Chew 1993: circumcentres of bad triangles are inserted).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "arrangement/mesher/patch_boundary.hpp"
#include "core/monitor.hpp"

namespace vdwmesh {

// What a piece of the boundary is split for: anything, or only what makes the triangles wrong.
enum class Demand : std::uint8_t { quality, validity };

// How far a patch is meshed: only its boundary is looked at, or all of it.
enum class PatchStage : std::uint8_t { boundary, triangles };

struct PatchOptions {
  double edge_length;  // by the radius
  Demand demand = Demand::quality;
  PatchStage stage = PatchStage::triangles;
  Monitor* monitor = nullptr;  // asked now and then whether to stop
};

// Either triangles, or the pieces that must be split first.
struct PatchMesh {
  std::vector<Vec3d> interior;  // directions; numbered after the points of the boundary
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from outside
  std::vector<PieceSplit> splits;                       // each piece once
};

// Precondition: at least one piece, and one cap. Every triangle faces outwards, and no edge but a
// piece has both ends on one circle, so triangles of different spheres do not meet. Throws
// CoincidentPoints (flat_boundary.hpp), Cancelled.
PatchMesh mesh_patch(const PatchBoundary& boundary, const PatchOptions& options);

// The whole sphere: an icosahedron with its faces divided, vertices on the unit sphere.
PatchMesh mesh_sphere(double edge_length);
// Its vertices alone, in another order.
std::vector<Vec3d> sphere_points(double edge_length);

}  // namespace vdwmesh
