// The smoothing and the search for defects (patch_smoothing.hpp), compiled for the host, in two
// versions, for two generations of processors.
#include "arrangement/mesher/patch_smoothing.hpp"
#include "core/multiversion.hpp"

namespace vdwmesh {

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
