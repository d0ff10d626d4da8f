#include "refine/target_surface.hpp"

#include <cmath>
#include <vector>

#include "core/errors.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {
namespace {

FieldModel model_of(const RefineOptions& o) {
  if (o.projection != Projection::field) return {};
  if (o.field.kind == FieldKind::vdw) {
    throw InvalidInput(
        "projection onto the field needs a blended field (blinn, soft, inverse-squared); project "
        "the vdw field with vdw");
  }
  if (!(o.grid.spacing > 0 && std::isfinite(o.grid.spacing))) {
    throw InvalidInput("projection onto the field needs the grid of the extraction");
  }
  return make_field_model(o.field, o.grid);
}

CellList list_of(const SphereSet& spheres, Projection projection, const FieldModel& model) {
  if (projection == Projection::field) return make_field_list(spheres, model);
  return make_ball_list(projection == Projection::vdw ? spheres : SphereSet());
}

}  // namespace

TargetSurface::TargetSurface(const SphereSet& spheres, const RefineOptions& options)
    : spheres_(spheres),
      projection_(options.projection),
      model_(model_of(options)),
      list_(list_of(spheres, projection_, model_)) {}

ProjectedPoint TargetSurface::project(const Vec3d& start, double reach) const {
  return projection_ == Projection::field ? project_to_field(list_.view(), model_, start, reach)
                                          : project_to_union(list_.view(), start, reach);
}

bool TargetSurface::on_label(const Vec3d& p, const VertexSpheres& label) const {
  if (label[0] == kNoSphere) return false;
  if (projection_ == Projection::field) return true;
  for (const SphereId id : label) {
    if (id != kNoSphere && !(std::abs(gap(spheres_[id], p)) <= kProjectionTolerance)) return false;
  }
  return true;
}

Vec3f TargetSurface::normal(const Vec3d& p, const VertexSpheres& label) const {
  if (projection_ == Projection::field) {
    const FieldSample sample = sample_field(list_.view(), model_, p);
    if (squared_norm(sample.gradient) > 0) return unit_normal(-1.0 * sample.gradient);
  }
  return union_normal(spheres_.spheres().data(), label.data(), p);
}

}  // namespace vdwmesh
