// The surface that a run projects to, with the search structure it needs.
#pragma once

#include "extract/cell_list.hpp"
#include "extract/field.hpp"
#include "extract/indexed_mesh.hpp"
#include "refine/projection_formulas.hpp"
#include "refine/refiner.hpp"

namespace vdwmesh {

class TargetSurface {
 public:
  // Throws InvalidInput for options without sense. `spheres` must outlive it.
  TargetSurface(const SphereSet& spheres, const RefineOptions& options);

  Projection projection() const { return projection_; }

  // Moves `start` onto the surface within `reach` (Å). Precondition: projection() is not none.
  ProjectedPoint project(const Vec3d& start, double reach) const;

  // Whether a vertex that lies on the surface may keep its label.
  bool on_label(const Vec3d& p, const VertexSpheres& label) const;

  // Unit outward normal at a vertex of the surface.
  Vec3f normal(const Vec3d& p, const VertexSpheres& label) const;

 private:
  const SphereSet& spheres_;
  Projection projection_;
  FieldModel model_{};
  CellList list_;
};

}  // namespace vdwmesh
