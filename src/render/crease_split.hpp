// Makes sharp creases visible in pictures of meshes whose triangles name their spheres.
#pragma once

#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Returns a copy of the mesh for drawing, with the same triangles in the same order. A vertex is
// repeated for each sphere to which triangles around it belong. Each copy is labelled with that
// sphere alone and has its outward normal. So light and colour change abruptly at a crease instead
// of blending across the triangles beside it. Positions stay the same. Throws InvalidInput if
// `triangle_spheres` is missing or names no sphere of the set.
IndexedMesh split_at_creases(const IndexedMesh& mesh, const SphereSet& spheres);

}  // namespace vdwmesh
