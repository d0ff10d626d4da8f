// The surface that a CPU refinement projects to, with the cell list in which the projection
// searches for balls. It puts the host's arrays behind a SurfaceView.
#pragma once

#include "refine/refiner.hpp"
#include "refine/surface_view.hpp"
#include "spheres/cell_list.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

class TargetSurface {
 public:
  // `spheres` and `workspace` must outlive the object; the memory of the cell list belongs to
  // `workspace`. If the triangles of the mesh name their spheres, or options.projection is none,
  // the list is empty, and project() must not be called. Throws InvalidInput as projection_model()
  // does.
  TargetSurface(const SphereSet& spheres, const RefineOptions& options, TriangleLabels labels,
                Workspace& workspace);

  // The surface of a view, whose arrays must outlive the object.
  explicit TargetSurface(const SurfaceView& view) : view_(view) {}

  Projection projection() const { return view_.projection; }
  // The members of SurfaceView, with its preconditions.
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
