// Pictures of meshes, as verbs make them.
#pragma once

#include <functional>

#include "spheres/sphere_set.hpp"
#include "steps/picture_options.hpp"
#include "steps/session.hpp"
#include "structure/molecule.hpp"
#include "surface/indexed_mesh.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh::apps {

// What the surface is painted with is chosen when it is known which mesh is drawn.
using Painter = std::function<Paint(const IndexedMesh&)>;

// Throws InvalidInput where options.color asks for the exposure of residues, and the radii have no
// references for it.
void check_references(const PictureOptions& options, const Molecule& molecule);

// The vertices' atoms, as options.color says: their CPK colours by default. Exposures are measured
// for it. A note says which colour is whose where that is no scale of numbers.
Paint paint_by_atom(const IndexedMesh& mesh, const Molecule& molecule,
                    const PictureOptions& options, Session& session);
// Signed distance of every triangle's centre to the boundary of the union: where a mesh has its
// vertices on the surface, its error is between them.
Paint paint_by_distance(const IndexedMesh& mesh, const SphereSet& spheres,
                        const PictureOptions& options, Session& session);
// The kind of every patch, or its mean or Gaussian curvature, as options.color says. `shown` is
// what split_at_patches() made of the mesh.
Paint paint_by_patch(const IndexedMesh& shown, const PatchedMesh& mesh,
                     const PictureOptions& options);
// Smallest angle of every triangle.
Paint paint_by_angle(const IndexedMesh& mesh, const PictureOptions& options);

// Draws, writes the file, and fills report.picture. CUDA fills the vertex buffers where it is the
// backend of the report, or, where that has none, of the machine; where it cannot, the host does,
// and a note says why.
void draw_mesh(const IndexedMesh& mesh, const Painter& painter, const PictureOptions& options,
               Session& session);
// The same, with sharp creases where the triangles know their spheres.
void draw_surface(const IndexedMesh& mesh, const SphereSet& spheres, const Painter& painter,
                  const PictureOptions& options, Session& session);
// The same, coloured by distance.
void draw_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                    const PictureOptions& options, Session& session);

}  // namespace vdwmesh::apps
