// Topology and measures of a mesh by CGAL's package Polygon Mesh Processing.
//
// CGAL has adapters for OpenMesh, so its functions work on a SurfaceMesh directly, without a
// conversion. This file shares no code with mesh_measures.cpp, which it serves to check.
#include "analysis/survey/cgal_measures.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/boost/graph/graph_traits_TriMesh_ArrayKernelT.h>
#include <CGAL/boost/graph/helpers.h>
#include <tbb/parallel_invoke.h>

#include <boost/property_map/function_property_map.hpp>
#include <iterator>
#include <utility>
#include <vector>

namespace vdwmesh {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Face = boost::graph_traits<SurfaceMesh>::face_descriptor;

// Counts the pieces that are connected across edges. CGAL writes the number of each face's piece
// into a property map; here the map refers to a plain vector, indexed by face.
std::uint64_t count_shells(const SurfaceMesh& mesh) {
  std::vector<std::size_t> shell_of(mesh.n_faces());
  return pmp::connected_components(
      mesh, boost::make_function_property_map<Face>([&](Face f) -> std::size_t& {
        return shell_of[static_cast<std::size_t>(f.idx())];
      }));
}

// Counts the pairs of faces that intersect other than in a shared vertex or edge.
std::uint64_t count_self_intersections(const SurfaceMesh& mesh) {
  std::vector<std::pair<Face, Face>> pairs;
  pmp::self_intersections(mesh, std::back_inserter(pairs));
  return pairs.size();
}

}  // namespace

CgalMeasures cgal_measures(const SurfaceMesh& mesh, SelfIntersectionTest test) {
  CgalMeasures result{};
  result.closed = CGAL::is_closed(mesh);
  // Before the others, which only read: CGAL may keep the numbers of faces in the mesh.
  result.shells = count_shells(mesh);
  tbb::parallel_invoke([&] { result.valid = CGAL::is_valid_polygon_mesh(mesh); },
                       [&] { result.area = pmp::area(mesh); },
                       [&] {
                         if (!result.closed) return;
                         result.volume = pmp::volume(mesh);
                         result.outward = mesh.n_faces() == 0 || pmp::is_outward_oriented(mesh);
                       });
  if (test == SelfIntersectionTest::run) result.self_intersections = count_self_intersections(mesh);
  return result;
}

}  // namespace vdwmesh
