// Estimates how much surface a set of balls has, and where, without extracting a mesh. The
// program's memory plan (apps/memory_plan.cpp) uses it to predict the size of the mesh, and ranks
// share the surface by it (distributed/shares/surface_shares.hpp).
#pragma once

#include <span>
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

// The spheres of a set are divided into parts: part p has the numbers from size * p / parts to
// size * (p + 1) / parts. At most 2048 spheres of each part are its sample.
//
// spheres_near_samples() looks at the spheres of one part, here called a block, and returns
// [p]: those that may have an effect on the surface of the sample of part p, ascending.
// sample_surface() returns some ten thousand points of the surface, on the sample of a part. `near`
// must be what all blocks have near this sample, one behind the other.
//
// The sum of the areas of all parts estimates the area of the surface: it is within some 10 % of it
// for sets of spheres of like size. The samples show where the surface is, which helps to divide
// work and nothing else. The same set always gives the same samples, in the same order. For an
// empty part there are none.
std::vector<std::vector<SphereId>> spheres_near_samples(const SphereSet& spheres,
                                                        const FieldModel& model, std::size_t block,
                                                        std::size_t parts);
std::vector<SurfaceSample> sample_surface(const SphereSet& spheres, const FieldModel& model,
                                          std::size_t part, std::size_t parts,
                                          std::span<const SphereId> near);

}  // namespace vdwmesh
