// How much surface a set of balls has, before anything is made of it.
#pragma once

#include "extract/field.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Area of the boundary of the union, Å², from points on a sample of the spheres: to 3 % for sets of
// thousands, to 10 % for less. For limits, not for reports. Always the same for the same set.
double estimate_area(const SphereSet& spheres);

// Area of the isosurface of a blended field, Å², likewise: to 10 % where the surface is smooth.
// What an atom with the largest contribution in other places as well has there is left out.
// Precondition: model.kind is not vdw.
double estimate_area(const SphereSet& spheres, const FieldModel& model);

}  // namespace vdwmesh
