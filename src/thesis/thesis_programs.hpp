// The two CPU programs of Dias's thesis (Tables 4.1 and 4.2), plain, on a dense grid, one thread:
// the baseline that `vdwmesh bench thesis` times. docs/thesis.md has how they were recovered.
//
// Stages: the field of every atom is added to the nodes of a sub-grid around the atom's voxel; an
// 8-bit flag per voxel; the table of triangles; linear interpolation (2.3); the normal of a vertex
// is the analytic gradient of F, summed over all atoms. Single precision, as on the thesis's GPU.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec3.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

enum class ThesisFunction { blinn, soft_object, inverse_squared };

// Which nodes an atom in voxel v = floor((c - origin) / h) reaches, per axis.
enum class SubGrid { voxels, nodes };  // v - n .. v + 1 + n (corners of the voxels); v - n .. v + n

struct ThesisParameters {
  ThesisFunction function = ThesisFunction::inverse_squared;
  double spacing = 0.4;    // h, Å
  double padding = 5.0;    // Å beyond the box of the atom centres
  double blob = 0;         // b: 1/Å^2 for Blinn, Å for the soft object
  double threshold = 4.8;  // T: in units of a, or C/Å^2 for inverse squared
  int half_width = 20;     // n of the sub-grid, voxels
  SubGrid sub_grid = SubGrid::nodes;
};

// The fitted parameters of docs/thesis.md for Tables 4.1-4.3 and for the van der Waals stage of
// Tables 4.4-4.5.
ThesisParameters thesis_parameters(ThesisFunction function);
ThesisParameters thesis_vdw_parameters();

struct ThesisGrid {
  Vec3d origin;
  Vec3i voxels;  // cells; one node more per axis
  std::int64_t voxel_count() const { return voxels.x * voxels.y * voxels.z; }
};
// Voxels per axis: floor((extent + 2 padding) / h).
ThesisGrid thesis_grid(std::span<const Vec3d> atoms, const ThesisParameters& parameters);

// Values at the nodes, x fastest.
std::vector<float> thesis_field(std::span<const Vec3d> atoms, const ThesisGrid& grid,
                                const ThesisParameters& parameters);

// Triangles that marching cubes makes of a field.
std::int64_t count_triangles(const std::vector<float>& field, const ThesisGrid& grid,
                             double threshold);

enum class SharedVertices { recomputed, hash_table };  // Table 4.1; Table 4.2

struct ThesisMesh {
  std::vector<Vec3f> positions, normals;
  std::vector<Triangle> triangles;
};
ThesisMesh thesis_marching_cubes(std::span<const Vec3d> atoms, const std::vector<float>& field,
                                 const ThesisGrid& grid, const ThesisParameters& parameters,
                                 SharedVertices shared);

}  // namespace vdwmesh
