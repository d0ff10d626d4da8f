// Estimates how much surface a set of balls has, and where, without extracting a mesh. The
// program's memory plan (apps/memory_plan.cpp) uses it to predict the size of the mesh, and ranks
// share the surface by it (distributed/surface_shares.hpp).
#pragma once

#include <vector>

#include "core/vec3.hpp"
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

// A point of a surface, the sphere whose part of the surface it lies on, and the area for which it
// stands.
struct SurfaceSample {
  SphereId sphere;
  Vec3d point;  // Å
  double area;  // Å²
};

// Some ten thousand points of the surface, on at most 2048 of the spheres with numbers from
// size * part / parts to size * (part + 1) / parts. The sum of the areas of all parts estimates the
// area of the surface: it is within some 10 % of it for sets of spheres of like size. The samples
// show where the surface is, which helps to divide work and nothing else. The same set always gives
// the same samples, in the same order. For an empty part there are none.
std::vector<SurfaceSample> sample_surface(const SphereSet& spheres, const FieldModel& model,
                                          std::size_t part, std::size_t parts);

}  // namespace vdwmesh
