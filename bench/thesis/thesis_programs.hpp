// The two CPU programs of Dias's thesis (Tables 4.1 and 4.2), rewritten as the baseline that the
// benchmark of the thesis's tables times. They run on one thread, in single precision, on a dense
// grid.
//
// Both programs are marching cubes on a sum of atom functions. They differ in one point: in the
// first every voxel computes the vertices on its edges anew, in the second voxels share them by a
// hash table. docs/thesis.md says how grid, functions and parameters were recovered from the
// tables.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec3.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

enum class ThesisFunction { blinn, soft_object, inverse_squared };

// The sub-grid of an atom at c: the nodes to which the atom contributes. Along each axis the atom
// is in voxel v = floor((c - origin) / h), between the nodes v and v + 1, and n is the half width.
//   voxels: nodes v - n … v + n + 1, all corners of the voxels v - n … v + n
//   nodes:  nodes v - n … v + n
enum class SubGrid { voxels, nodes };

struct ThesisParameters {
  ThesisFunction function = ThesisFunction::inverse_squared;
  double spacing = 0.4;    // h, Å
  double padding = 5.0;    // Å beyond the box of the atom centres
  double blob = 0;         // b: 1/Å^2 for Blinn, Å for the soft object
  double threshold = 4.8;  // T of the isosurface: in units of a, or C/Å^2 for inverse squared
  int half_width = 20;     // n of the sub-grid, voxels
  SubGrid sub_grid = SubGrid::nodes;
};

// The parameters that docs/thesis.md fits: for each function to Tables 4.1-4.3, and for the van der
// Waals surface (inverse squared) to Tables 4.4-4.5.
ThesisParameters thesis_parameters(ThesisFunction function);
ThesisParameters thesis_vdw_parameters();

struct ThesisGrid {
  Vec3d origin;  // the lower corner, Å
  Vec3i voxels;  // number of cells along each axis; there is one node more
  std::int64_t voxel_count() const { return voxels.x * voxels.y * voxels.z; }
};
// Returns the grid around the box of the atom centres, with floor((extent + 2 padding) / h) voxels
// along each axis. Precondition: there is at least one atom.
ThesisGrid thesis_grid(std::span<const Vec3d> atoms, const ThesisParameters& parameters);

// Returns the values of the summed field at all nodes, x fastest.
std::vector<float> thesis_field(std::span<const Vec3d> atoms, const ThesisGrid& grid,
                                const ThesisParameters& parameters);

// Counts the triangles that marching cubes makes of a field, without making them.
std::int64_t count_triangles(const std::vector<float>& field, const ThesisGrid& grid,
                             double threshold);

// How voxels obtain the vertices of their edges: `recomputed` in the program of Table 4.1, from a
// `hash_table` in the program of Table 4.2.
enum class SharedVertices { recomputed, hash_table };

struct ThesisMesh {
  std::vector<Vec3f> positions, normals;  // positions in Å, relative to the origin of the grid
  std::vector<Triangle> triangles;
};
// Runs marching cubes on a field from thesis_field() with the same atoms, grid and parameters.
ThesisMesh thesis_marching_cubes(std::span<const Vec3d> atoms, const std::vector<float>& field,
                                 const ThesisGrid& grid, const ThesisParameters& parameters,
                                 SharedVertices shared);

}  // namespace vdwmesh
