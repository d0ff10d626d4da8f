#include "refine/target_surface.hpp"

#include "refine/preparation.hpp"

namespace vdwmesh {

TargetSurface::TargetSurface(const SphereSet& spheres, const RefineOptions& options,
                             TriangleLabels labels)
    : list_(projection_list(spheres, options, labels)),
      view_{options.projection, list_.view(), projection_model(options), spheres.spheres().data()} {
}

}  // namespace vdwmesh
