// Meshes of the excluded surface at any density: fewer and better triangles than the mesh along the
// curves between patches (excluded_mesher.hpp) can have, with the same topology.
//
// The surface is smooth across most of those curves, so its mesh need not follow them. The exact
// mesh is made, and its edges are collapsed, split and flipped and its vertices moved until they
// are about as long as wanted (M. Botsch and L. Kobbelt, SGP 2004). Every vertex stays on the exact
// surface. Creases between the concave patches of two probes stay chains of edges with their
// vertices on the crease, and corners and cusps stay vertices; those nearer to each other than 0.4
// edge lengths may be joined, and are counted. No operation changes χ or a shell, and no two
// triangles cross.
#pragma once

#include <cstdint>

#include "excluded/excluded_mesher.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh {

struct RemeshOptions {
  double probe = kWaterProbe;  // Å, above 0
  double edge_length = 1.07;   // Å, about the mean; shorter at waists and between near corners
  bool exterior = false;       // as ExcludedMeshOptions::exterior
  std::uint64_t memory_limit = kNoMemoryLimit;  // bytes
  Monitor* monitor = nullptr;
};

struct RemeshStats {
  std::uint64_t exact_triangles = 0;            // triangles of the mesh that it started from
  std::uint64_t crease_edges = 0, corners = 0;  // crease edges and corners of that mesh
  std::uint64_t joined = 0;                     // corners and crease vertices that joined others
  std::uint64_t below_20_degrees = 0;           // triangles with an angle below 20°
  std::uint64_t below_20_at_features = 0;       // of these, those with a vertex on a feature
  int runs = 0;                                 // more than 1: crossings were found and undone
  double edge_length = 0;                       // Å, that was asked for or found
  double farthest = 0;  // Å, of remesh_within(): proven, both ways; 0 of other meshes
  double exact_seconds = 0, seconds = 0;  // wall time: of the exact mesh, and in all
};

// Of the mesh: outward normals; the label of a vertex is the atom of its patch whose sphere is
// nearest. `vertex_patch` names the patch of each vertex, and `triangle_patch` that of the foot of
// each triangle's middle. refine_patches() does not take such a mesh.
struct RemeshedSurface : PatchedMesh {
  RemeshStats stats;
};

// The edge length of equilateral triangles, of which so many have 1 Å²: one has √3/4 L².
double edge_length_of_density(double triangles_per_area);

// The result depends on the arguments alone. Throws as mesh_excluded() does.
RemeshedSurface remesh_excluded(const SphereSet& atoms, const RemeshOptions& options = {});

// A mesh with few triangles of which no point is farther than `max_distance` (Å) from the surface,
// and no point of the surface from the mesh: excluded_distance_bounds() proves it. Meshes are made
// until one is near enough, and not much nearer; `options.edge_length` is the first one's. Throws
// LimitExceeded if none is found, and as remesh_excluded() does.
RemeshedSurface remesh_within(const SphereSet& atoms, double max_distance,
                              const RemeshOptions& options = {});

}  // namespace vdwmesh
