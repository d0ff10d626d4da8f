// The view of the surface is all that projection needs; the list in it belongs to the workspace.
#include "refine/target_surface.hpp"

#include "refine/preparation.hpp"

namespace vdwmesh {

TargetSurface::TargetSurface(const SphereSet& spheres, const RefineOptions& options,
                             TriangleLabels labels, Workspace& workspace)
    : view_{options.projection, projection_list(spheres, options, labels, workspace),
            projection_model(options), spheres.spheres().data()} {}

}  // namespace vdwmesh
