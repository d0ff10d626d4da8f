// Makes the view of the target surface: projection, cell list, field and spheres, in this order.
// preparation.cpp makes the list, whose memory belongs to the workspace, and the field.
#include "refine/target_surface.hpp"

#include "refine/preparation.hpp"

namespace vdwmesh {

TargetSurface::TargetSurface(const SphereSet& spheres, const RefineOptions& options,
                             TriangleLabels labels, Workspace& workspace)
    : view_{options.projection, projection_list(spheres, options, labels, workspace),
            projection_model(options), spheres.spheres().data()} {}

}  // namespace vdwmesh
