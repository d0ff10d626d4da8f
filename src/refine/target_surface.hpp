// The surface that a run projects to, with the search structure it needs.
#pragma once

#include "refine/refiner.hpp"
#include "refine/surface_view.hpp"
#include "spheres/cell_list.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

class TargetSurface {
 public:
  // Throws InvalidInput for options without sense. `spheres` and `workspace`, in which the cell
  // list stands, must outlive it. If triangles name their spheres, nothing is ever searched, and
  // project() must not be called.
  TargetSurface(const SphereSet& spheres, const RefineOptions& options, TriangleLabels labels,
                Workspace& workspace);

  Projection projection() const { return view_.projection; }
  ProjectedPoint project(const Vec3d& start, double reach) const {
    return view_.project(start, reach);
  }
  bool on_label(const Vec3d& p, const VertexSpheres& label) const {
    return view_.on_label(p, label.data());
  }
  Vec3f normal(const Vec3d& p, const VertexSpheres& label) const {
    return view_.normal(p, label.data());
  }

 private:
  SurfaceView view_;
};

}  // namespace vdwmesh
