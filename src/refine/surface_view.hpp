// The surface that a run projects to, as host and device code see it.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "extract/blended/field_sample.hpp"
#include "refine/projection_formulas.hpp"
#include "refine/refiner.hpp"
#include "refine/subdivision_formulas.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// Trivially copyable; owns nothing.
struct SurfaceView {
  Projection projection;
  CellListView list;      // reach = radius for vdw, field_reach() for field
  FieldModel model;       // of field
  const Sphere* spheres;  // in the caller's order, as vertex labels name them

  // Moves `start` onto the surface within `reach` (Å). Precondition: projection is not none.
  VDWMESH_HD ProjectedPoint project(const Vec3d& start, double reach) const {
    return projection == Projection::field ? project_to_field(list, model, start, reach)
                                           : project_to_union(list, start, reach);
  }

  // Whether a vertex that lies on the surface may keep its label.
  VDWMESH_HD bool on_label(const Vec3d& p, const SphereId* label) const {
    if (label[0] == kNoSphere) return false;
    if (projection == Projection::field) return true;
    for (int i = 0; i < 3; ++i) {
      if (label[i] == kNoSphere) continue;
      const double off = gap(spheres[label[i]], p);
      if (!(off <= kProjectionTolerance && off >= -kProjectionTolerance)) return false;
    }
    return true;
  }

  // Unit outward normal at a vertex of the surface.
  VDWMESH_HD Vec3f normal(const Vec3d& p, const SphereId* label) const {
    if (projection == Projection::field) {
      const FieldSample sample = sample_field(list, model, p);
      if (squared_norm(sample.gradient) > 0) return unit_normal(-1.0 * sample.gradient);
    }
    return union_normal(spheres, label, p);
  }
};

}  // namespace vdwmesh
