// Area and signed volume of the shells of a mesh, without rounding, so that they do not depend on
// how the mesh is divided.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "measures/exact_sum.hpp"
#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Some of the terms that add up to area and volume of a shell.
struct ShellTerm {
  std::uint64_t shell;  // its name, of any value
  double area, volume;  // Å², Å³
};

// The smallest box around the vertices. The middle of that of a whole mesh is the origin of
// volumes: coordinates relative to it are no larger than the mesh, so volumes of meshes far from
// the coordinate origin do not lose digits.
Box box_of_vertices(const IndexedMesh& mesh);

// The terms of the triangles [0, shell_of.size()), of which triangle t belongs to the shell
// shell_of[t]. The exact sums of a shell's terms are those of its triangles: with the edge vectors
// u, v at a corner a the area is |u × v| / 2, and the volume of the tetrahedron to `origin` is
// (a - origin) · (u × v) / 6, positive for triangles that face outwards (divergence theorem). There
// are few terms for each run of consecutive triangles of one shell.
std::vector<ShellTerm> shell_terms(const IndexedMesh& mesh, std::span<const std::uint32_t> shell_of,
                                   const Vec3d& origin);

// What shells add up to. A shell of positive volume is the outer surface of a component, one of
// negative volume that of a void, and one of volume 0 is neither.
struct ShellTotals {
  ExactSum area, volume, outer_area, void_area;
  std::uint64_t components = 0, voids = 0;
};
void add(ShellTotals& totals, const ShellTotals& other);
// Adds whole shells, each given by all of its terms, in any order.
void add_shells(ShellTotals& totals, std::vector<ShellTerm> terms);

// What can be counted of a mesh.
struct MeshCounts {
  bool closed, manifold, oriented;  // as in MeshTopology
  std::uint64_t vertices, used_vertices, edges, triangles, shells;
};
MeshTopology topology_of(const MeshCounts& counts, const ShellTotals& totals);
MeshMeasures measures_of(const MeshCounts& counts, const ShellTotals& totals);

}  // namespace vdwmesh
