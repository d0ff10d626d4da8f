// The same questions put to CGAL's Polygon Mesh Processing on the OpenMesh mesh itself: an
// independent check of topology() and measures().
#pragma once

#include <cstdint>
#include <optional>

#include "mesh/surface_mesh.hpp"

namespace vdwmesh {

struct CgalMeasures {
  bool closed;
  bool valid;  // CGAL::is_valid_polygon_mesh
  std::uint64_t shells;
  double area;  // Å²
  // Of closed meshes only:
  std::optional<double> volume;  // Å³, signed
  std::optional<bool> outward;   // every shell bounds a volume; false too where a void is wound in
  std::optional<std::uint64_t> self_intersections;  // null where not asked for
};

enum class SelfIntersectionTest { skip, run };

// Triangles up to which a report asks CGAL too; beyond, the check would take longer than the mesh.
inline constexpr std::uint64_t kCgalMeasuresLimit = 1'000'000;

// Sums are plain doubles about the coordinate origin, as CGAL takes them. Self-intersections take
// about 1 s per 400,000 triangles, everything else about 1 s per 10^6.
CgalMeasures cgal_measures(const SurfaceMesh& mesh,
                           SelfIntersectionTest test = SelfIntersectionTest::skip);

}  // namespace vdwmesh
