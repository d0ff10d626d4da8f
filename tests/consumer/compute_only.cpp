// A program outside the project that meshes and draws nothing.
#include <cstdio>
#include <vdwmesh/cuda/backend.hpp>

int main() {
  const vdwmesh::SphereSet molecule({{{0, 0, 0}, 1.7}});
  const auto pipeline = vdwmesh::make_pipeline(vdwmesh::Backend::automatic);
  const vdwmesh::IndexedMesh mesh = pipeline->run(molecule, {}, {}).mesh;
  std::printf("%zu vertices, %zu triangles\n", mesh.vertex_count(), mesh.triangle_count());
  // Euler's formula for a sphere: V - E + F = 2, with three half-edges a triangle.
  return mesh.vertex_count() == 2 + mesh.triangle_count() / 2 ? 0 : 1;
}
