// The triangulation in the plane (plane_insertion.hpp, piece_insertion.hpp), compiled for the host.
// What takes most of the time is compiled in two versions, for two generations of processors.
#include "arrangement/mesher/plane_triangulation.hpp"

#include "arrangement/mesher/piece_insertion.hpp"
#include "arrangement/mesher/plane_insertion.hpp"
#include "core/multiversion.hpp"

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

}  // namespace vdwmesh
