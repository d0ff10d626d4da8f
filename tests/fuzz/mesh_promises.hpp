// What every mesh of a set of balls promises, found by the reference code.
#pragma once

#include "fuzz/fuzz_target.hpp"
#include "reference/mesh_checks.hpp"
#include "support/reference_mesh.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::fuzz {

// Returns what was found, for promises of one mesher alone.
inline reference::MeshFacts check_mesh(const IndexedMesh& mesh, std::size_t spheres) {
  require(mesh.normals.size() == mesh.vertex_count(), "every vertex has a normal");
  require(mesh.vertex_spheres.size() == mesh.vertex_count(), "every vertex has its spheres");
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const VertexSpheres labels = mesh.vertex_spheres[v];
    require(labels[0] < spheres, "the first label is a sphere");
    for (const SphereId id : labels) require(id < spheres || id == kNoSphere, "labels are spheres");
  }
  for (const Vec3f& n : mesh.normals) {
    require(std::abs(norm(n) - 1) < 1e-5f, "normals are unit vectors");
  }
  const reference::MeshFacts facts = reference::inspect(testing::to_reference(mesh));
  if (!mesh.triangles.empty() && !facts.closed_oriented_manifold()) {
    std::fprintf(stderr, "%s\n", facts.summary().c_str());
    require(false, "the mesh is closed, oriented and 2-manifold");
  }
  return facts;
}

}  // namespace vdwmesh::fuzz
