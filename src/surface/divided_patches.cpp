// Looks at all patches of a mesh on all cores. The least and largest vertices do not depend on how
// the patches are shared among them.
#include "surface/divided_patches.hpp"

#include <algorithm>

#include "core/blocks.hpp"

namespace vdwmesh {

PatchVertices survey_patches(const IndexedMesh& mesh) {
  return reduce_all(
      mesh.triangle_count() / 4, PatchVertices{},
      [&](std::size_t t, PatchVertices& all) {
        const Triangle corner = corners_of_patch(mesh, t);
        const Triangle& middle = midpoints_of_patch(mesh, t);
        all.all_are_patches &= is_patch(mesh, t);
        all.last_corner = std::max({all.last_corner, corner[0], corner[1], corner[2]});
        all.first_midpoint = std::min({all.first_midpoint, middle[0], middle[1], middle[2]});
      },
      [](const PatchVertices& a, const PatchVertices& b) {
        return PatchVertices{a.all_are_patches && b.all_are_patches,
                             std::max(a.last_corner, b.last_corner),
                             std::min(a.first_midpoint, b.first_midpoint)};
      });
}

}  // namespace vdwmesh
