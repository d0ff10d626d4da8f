// Topology and measures of a SurfaceMesh by CGAL's package Polygon Mesh Processing.
//
// They serve as an independent check of topology() and measures() in mesh_measures.hpp, which work
// on an IndexedMesh with code of this project.
#pragma once

#include <cstdint>
#include <optional>

#include "mesh/surface_mesh.hpp"

namespace vdwmesh {

struct CgalMeasures {
  bool closed;           // no edge is on the boundary
  bool valid;            // CGAL::is_valid_polygon_mesh
  std::uint64_t shells;  // pieces that are connected across edges
  double area;           // Å²
  // The next two have values for closed meshes only:
  std::optional<double> volume;  // Å³, signed; positive if the faces are oriented outwards
  // CGAL::is_outward_oriented. CGAL looks only at the faces around the vertex with the largest z,
  // so this is the orientation of the shell of that vertex and says nothing about other shells.
  std::optional<bool> outward;
  std::optional<std::uint64_t> self_intersections;  // pairs of faces; empty if not requested
};

enum class SelfIntersectionTest { skip, run };

// Reports include CGAL's measures of meshes up to this number of triangles. For larger meshes the
// check would take longer than all other stages.
inline constexpr std::uint64_t kCgalMeasuresLimit = 1'000'000;

// Area and volume are plain sums in double. CGAL measures volumes from the coordinate origin, so a
// mesh far from it loses digits. The test for self-intersections takes about 1 s for 400,000
// triangles, everything else about 1 s for 10^6.
CgalMeasures cgal_measures(const SurfaceMesh& mesh,
                           SelfIntersectionTest test = SelfIntersectionTest::skip);

}  // namespace vdwmesh
