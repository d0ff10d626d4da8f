// The smoothing and the search for defects (patch_smoothing.hpp), compiled for the host. The
// smoothing is compiled in two versions, for two generations of processors.
#include <algorithm>

#include "arrangement/mesher/patch_smoothing.hpp"
#include "core/multiversion.hpp"

namespace vdwmesh {

template <>
VDWMESH_MULTIVERSION void smooth(const PatchBoundaryView& boundary, const PointCircles& circles,
                                 int passes, SmoothingScratch& scratch, PatchTriangles& patch) {
  smoothing::Smoother<GrowingMemory>(boundary, circles, scratch, patch).run(passes);
}

template void find_defects(const PatchBoundaryView& boundary, const PatchTriangles& patch,
                           std::vector<std::uint32_t>& found);

std::vector<std::uint32_t> defects(const PatchBoundary& boundary, const PatchTriangles& patch) {
  std::vector<std::uint32_t> found;
  find_defects<GrowingMemory>(boundary, patch, found);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace vdwmesh
