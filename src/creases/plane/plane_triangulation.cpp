// The triangulation in the plane (plane_insertion.hpp, piece_insertion.hpp), and the smoothing and
// the search for defects (patch_smoothing.hpp), compiled for the host.
// What takes most of the time is compiled in two versions, for two generations of processors.
#include "creases/plane/plane_triangulation.hpp"

#include "core/lanes/multiversion.hpp"
#include "creases/patch/patch_smoothing.hpp"
#include "creases/plane/piece_insertion.hpp"
#include "creases/plane/plane_insertion.hpp"

namespace vdwmesh {

template <>
VDWMESH_MULTIVERSION PlaneTypes::Location PlaneTriangulation::locate(const PlanePoint& p,
                                                                     std::uint32_t near) {
  return locate_here(p, near);
}

template <>
VDWMESH_MULTIVERSION void PlaneTriangulation::insert(std::uint32_t vertex, const Location& at) {
  insert_here(vertex, at);
}

template class PlaneTriangulationOf<GrowingMemory>;

template <>
VDWMESH_MULTIVERSION void smooth(const PatchBoundaryView& boundary, const PointCircles& circles,
                                 int passes, SmoothingScratch& scratch, PatchTriangles& patch) {
  smoothing::Smoother<GrowingMemory>(boundary, circles, scratch, patch).run(passes);
}

template <>
VDWMESH_MULTIVERSION bool find_defects(const PatchBoundaryView& boundary,
                                       const PatchTriangles& patch,
                                       PatchVector<std::uint32_t>& found) {
  return smoothing::DefectFinder<GrowingMemory>(boundary, patch, found).run();
}

}  // namespace vdwmesh
