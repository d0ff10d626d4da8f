// Makes sharp creases visible in pictures of meshes whose triangles name their spheres or patches.
#pragma once

#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh {

// Returns a copy of the mesh for drawing, with the same triangles in the same order. A vertex is
// repeated for each sphere to which triangles around it belong. Each copy is labelled with that
// sphere alone and has its outward normal. So light and colour change abruptly at a crease instead
// of blending across the triangles beside it. Positions stay the same. Throws InvalidInput if
// `triangle_spheres` is missing or names no sphere of the set.
IndexedMesh split_at_creases(const IndexedMesh& mesh, const SphereSet& spheres);

// The same at the curves between patches. Each copy of a vertex keeps the atom of the vertex and
// has the outward normal of its patch; in a cusp, where a saddle has none, that of the mesh. So
// light is smooth where patches are tangent and sharp at creases, and what differs between patches,
// such as their curvature, changes abruptly at the curve. Throws InvalidInput if `triangle_patch`
// does not fit the mesh or its patches.
IndexedMesh split_at_patches(const PatchedMesh& mesh);

}  // namespace vdwmesh
