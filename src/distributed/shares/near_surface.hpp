// The surface that a rank projects to, made from the spheres near its part alone.
#pragma once

#include <optional>

#include "core/workspace.hpp"
#include "distributed/shares/chosen_spheres.hpp"
#include "refine/refiner.hpp"
#include "refine/surface_view.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class NearSurface {
 public:
  // All spheres, and the options of the refinement, whose frame is that of the whole set. Both must
  // outlive the object.
  NearSurface(const SphereSet& spheres, const RefineOptions& options);

  // Chooses enough spheres for projections that start at points with z in this interval (Å) and try
  // points within `reach` of them: for all these points surface() gives the results that it has
  // with all spheres.
  void cover(double lower, double upper, double reach);

  // Labels that it makes or takes name spheres of the whole set. Precondition: cover().
  const SurfaceView& surface() const { return *surface_; }

 private:
  void choose_spheres(double lower, double upper);

  const SphereSet& spheres_;
  const RefineOptions& options_;
  FieldModel model_;
  double lower_ = 0, upper_ = -1;  // covered; at first nothing
  ChosenSpheres near_;
  SphereSet near_set_;  // a view of near_
  Workspace workspace_;
  Buffer<SphereId> ids_;  // by list place: id in the whole set
  std::optional<SurfaceView> surface_;
};

}  // namespace vdwmesh
