// Estimates how much surface a set of balls has, without extracting a mesh. The program's memory
// plan (apps/memory_plan.cpp) uses it to predict the size of the mesh.
#pragma once

#include "extract/field.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Estimates the area of the boundary of the union of balls, Å², from points on a sample of the
// spheres. The error is up to 3 % for sets of thousands of spheres and up to 10 % for smaller sets,
// good enough for limits but not for reports. The same set always gives the same estimate.
double estimate_area(const SphereSet& spheres);

// Estimates the area of the isosurface of a blended field, Å², in the same way. The error is up to
// 10 % if the surface is smooth. Left out are parts of the surface that a straight line from their
// atom's centre reaches only through the outside or through another atom's part. Precondition:
// model.kind is not vdw.
double estimate_area(const SphereSet& spheres, const FieldModel& model);

}  // namespace vdwmesh
