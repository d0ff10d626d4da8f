#include "extract/indexed_mesh.hpp"

#include <span>

namespace vdwmesh {
namespace {

template <class T>
std::uint64_t hash_bytes(const Buffer<T>& values) {
  std::uint64_t hash = 14695981039346656037ull;
  const auto bytes = std::as_bytes(std::span<const T>(values));
  for (const std::byte b : bytes) hash = (hash ^ static_cast<std::uint64_t>(b)) * 1099511628211ull;
  return hash;
}

}  // namespace

std::uint64_t indexed_mesh_bytes(std::uint64_t vertices, std::uint64_t triangles,
                                 Connectivity connectivity, TriangleLabels labels,
                                 Normals normals) {
  const std::uint64_t per_triangle =
      sizeof(Triangle) +
      (connectivity == Connectivity::half_edges ? 3 * sizeof(std::uint32_t) : 0) +
      (labels == TriangleLabels::spheres ? sizeof(SphereId) : 0);
  const std::uint64_t per_vertex =
      sizeof(Vec3d) + sizeof(VertexSpheres) + (normals == Normals::gradients ? sizeof(Vec3f) : 0);
  return vertices * per_vertex + triangles * per_triangle;
}

IndexedMeshHash hash(const IndexedMesh& mesh) {
  return {hash_bytes(mesh.positions), hash_bytes(mesh.normals), hash_bytes(mesh.vertex_spheres),
          hash_bytes(mesh.triangles), hash_bytes(mesh.triangle_spheres)};
}

}  // namespace vdwmesh
