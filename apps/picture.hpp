// Pictures of meshes, as verbs make them.
#pragma once

#include "core/monitor.hpp"
#include "picture_options.hpp"
#include "report.hpp"
#include "spheres/sphere_set.hpp"
#include "structure/molecule.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::apps {

// The mesh with sharp creases for drawing, where its triangles know their spheres; else empty.
IndexedMesh split_where_labelled(const IndexedMesh& mesh, const SphereSet& spheres);

// CPK colours of the vertices' atoms.
Paint paint_by_element(const IndexedMesh& mesh, const Molecule& molecule);
// Signed distance of every triangle's centre to the boundary of the union: where a mesh has its
// vertices on the surface, its error is between them.
Paint paint_by_distance(const IndexedMesh& mesh, const SphereSet& spheres,
                        const PictureOptions& options, Monitor* monitor);
// Smallest angle of every triangle.
Paint paint_by_angle(const IndexedMesh& mesh, const PictureOptions& options);

// Draws, writes the file, and fills report.picture. CUDA fills the vertex buffers where it is the
// backend of the report, or, where that has none, of the machine; where it cannot, the host does,
// and a note says why.
void write_picture(const IndexedMesh& mesh, Paint paint, const PictureOptions& options,
                   const MachineOptions& machine, Monitor* monitor, Report& report);

}  // namespace vdwmesh::apps
