// Patches: divided triangles, as refine/subdivision_formulas.hpp makes them. Triangles 4 t to
// 4 t + 3 of a mesh are patch t if they are the three children at its corners, each with the
// midpoints of the two sides that meet there, and the child of the midpoints.
#pragma once

#include <cstddef>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// The vertices of patch t, as far as the mesh is divided: its corners, and its midpoints, of which
// number k is that of the side from corner k to the next one.
inline Triangle corners_of_patch(const IndexedMesh& mesh, std::size_t t) {
  return {mesh.triangles[4 * t][0], mesh.triangles[4 * t + 1][0], mesh.triangles[4 * t + 2][0]};
}
inline const Triangle& midpoints_of_patch(const IndexedMesh& mesh, std::size_t t) {
  return mesh.triangles[4 * t + 3];
}

// Whether triangles 4 t to 4 t + 3 are a patch with three different corners.
inline bool is_patch(const IndexedMesh& mesh, std::size_t t) {
  const Triangle& m = midpoints_of_patch(mesh, t);
  const Triangle corners = corners_of_patch(mesh, t);
  bool is = corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
  for (std::size_t k = 0; k < 3; ++k) {
    const Triangle& child = mesh.triangles[4 * t + k];
    is &= child[1] == m[k] && child[2] == m[k == 0 ? 2 : k - 1];
  }
  return is;
}

// What the patches of a mesh have for vertices.
struct PatchVertices {
  bool all_are_patches = true;
  std::uint32_t last_corner = 0, first_midpoint = 0xffffffffu;

  // Whether all are patches, and all of their corners come before all of their midpoints.
  bool are_in_order() const { return all_are_patches && last_corner < first_midpoint; }
};

// Looks at every four consecutive triangles of the mesh, on all cores.
PatchVertices survey_patches(const IndexedMesh& mesh);

}  // namespace vdwmesh
