// The surface that a refinement projects to, as host and device code see it: the blended isosurface
// or the boundary of the union of the balls. target_surface() (refine/crossings/preparation.hpp)
// fills the arrays on the host, DeviceSurface (cuda/refine/device_refinement.cuh) on a device.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "extract/blended/field_sample.hpp"
#include "refine/projection_formulas.hpp"
#include "refine/refiner.hpp"
#include "refine/subdivision_formulas.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// Trivially copyable, so that it can be passed to kernels by value. It owns nothing.
struct SurfaceView {
  Projection projection;
  CellListView list;      // a ball's reach in it is its radius for vdw, its field_reach() for field
  FieldModel model;       // used for Projection::field only
  const Sphere* spheres;  // by sphere id, as vertex labels name them

  // Projects `start` onto the surface, moving it by at most `reach` (Å). Precondition: `projection`
  // is not none.
  VDWMESH_HD ProjectedPoint project(const Vec3d& start, double reach) const {
    return projection == Projection::field ? project_to_field(list, model, start, reach)
                                           : project_to_union(list, start, reach);
  }

  // Whether a vertex at point p of the surface may keep its label. The label must name a sphere.
  // For vdw, p must also be within kProjectionTolerance of every sphere that it names. The
  // isosurface of a field belongs to no single atom, so any label will do.
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

  // The unit outward normal at vertex p of the surface. A field grows towards the atoms, so its
  // outward direction is against the gradient. If the gradient is zero, the normals of the spheres
  // in the label are used instead.
  VDWMESH_HD Vec3f normal(const Vec3d& p, const SphereId* label) const {
    if (projection == Projection::field) {
      const FieldSample sample = sample_field(list, model, p);
      if (squared_norm(sample.gradient) > 0) return unit_normal(-1.0 * sample.gradient);
    }
    return union_normal(spheres, label, p);
  }
};

}  // namespace vdwmesh
