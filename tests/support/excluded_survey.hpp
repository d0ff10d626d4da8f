// What the contract of mesh_excluded() says of every vertex and triangle, checked from the balls.
#pragma once

#include <cstdint>
#include <string>

#include "reference/mesh_checks.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh::testing {

struct ExcludedSurvey {
  reference::MeshFacts facts;
  // Å: the largest distance of a vertex from the sphere, torus or probe's sphere of a triangle at
  // it.
  double off_patch = 0;
  // Triangles that face inwards: against the outward normal of their patch at one of their vertices
  // other than a cusp, where there is none.
  std::uint64_t inward = 0;
  std::uint64_t bad_labels = 0;  // of triangles: no patch, or atoms that do not fit its kind
  // Of vertices: not of length 1, or other than that of the patches where these have the same.
  std::uint64_t bad_normals = 0;
  double area_by_kind[3] = {0, 0, 0};  // Å², of the triangles

  bool sound() const;
  std::string text() const;
};

ExcludedSurvey survey_excluded(const SphereSet& atoms, double probe, const PatchedMesh& mesh);

}  // namespace vdwmesh::testing
