// Sharp creases in pictures of meshes that know the sphere of every triangle.
#pragma once

#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// A copy for drawing, of the same triangles in the same order: each vertex is repeated for every
// sphere whose triangles it is part of, lies on that sphere alone and has its outward normal, so
// that light and colours change at a crease and not across the triangles beside it. Positions stay
// as they are. Throws InvalidInput where `triangle_spheres` is missing or names no sphere of the
// set.
IndexedMesh split_at_creases(const IndexedMesh& mesh, const SphereSet& spheres);

}  // namespace vdwmesh
