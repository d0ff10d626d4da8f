// A blended field at one point, in double: its value, its gradient and the atom that contributes
// most. Newton projection in the refinement, the estimate of the area and tests use it; the
// extraction itself evaluates the field in float32 at the nodes of bricks. Host and device.
#pragma once

#include "core/host_device.hpp"
#include "extract/blended/field_formulas.hpp"
#include "extract/field_kinds.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

struct FieldSample {
  double value;
  Vec3d gradient;   // 1/Å
  ListPlace place;  // of the largest contribution, lowest rank among equals
  bool in_reach;    // some atom contributes more than 0; if false, `place` has no meaning
};

// Sums over the spheres near p in list order. Precondition: the reaches of `list` are those of
// field_reach(). The gradient of f(d^2) at p is 2 df/d(d^2) (p - centre). The visitor returns false
// on all paths, so that the visit goes on to the next sphere.
template <BlendedKind Kind>
VDWMESH_HD FieldSample sample_field(const CellListView& list, const FieldModel& model,
                                    const Vec3d& p) {
  const ShapeParameters<double> shape = shape_parameters<double>(model);
  FieldSample sample{0, {0, 0, 0}, ListPlace{}, false};
  double largest = 0;
  visit_near_box(list, p, p, [&](ListPlace place) {
    const Sphere& ball = list.spheres[place];
    if (model.truncation == Truncation::subgrid) {
      for (int axis = 0; axis < 3; ++axis) {
        const double units = (p[axis] - model.grid.origin[axis]) / model.grid.spacing;
        const std::int64_t cell = subgrid_cell(model.grid, axis, ball.center[axis]);
        if (!in_subgrid(units, cell, model.subgrid_cells)) return false;
      }
    }
    const ValueAndSlope<double> f = Kind::value_and_slope(shape, squared_distance(p, ball.center),
                                                          inverse_square_scale(model, ball.radius));
    if (!(f.value > 0)) return false;
    sample.value += f.value;
    const double twice = 2 * f.slope;
    for (int axis = 0; axis < 3; ++axis) {
      sample.gradient[axis] = std::fma(twice, p[axis] - ball.center[axis], sample.gradient[axis]);
    }
    const bool wins =
        f.value > largest || (f.value == largest && list.rank[place] < list.rank[sample.place]);
    if (!sample.in_reach || wins) {
      sample.place = place;
      largest = f.value;
    }
    sample.in_reach = true;
    return false;
  });
  return sample;
}

// sample_field<Kind>() for the kind that the model names. Precondition: model.kind is not vdw.
VDWMESH_HD inline FieldSample sample_field(const CellListView& list, const FieldModel& model,
                                           const Vec3d& p) {
  return with_blended(model.kind,
                      [&]<class Kind>(Kind) { return sample_field<Kind>(list, model, p); });
}

}  // namespace vdwmesh
