#include "mesh/weld.hpp"

#include <fmt/format.h>

#include "core/errors.hpp"
#include "mesh/vertex_welder.hpp"

namespace vdwmesh {

IndexedMesh welded(const IndexedMesh& mesh) {
  IndexedMesh result;
  formats::VertexWelder welder(result.positions);
  Buffer<std::uint32_t> index(mesh.vertex_count());
  const VertexLabels& labels = mesh.vertex_spheres;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const std::size_t before = result.vertex_count();
    index[v] = welder.index(mesh.positions[v]);
    if (result.vertex_count() == before) continue;
    if (!labels.empty()) result.vertex_spheres.atoms.push_back(labels.atoms[v]);
    if (!labels.others.empty()) result.vertex_spheres.others.push_back(labels.others[v]);
  }
  result.triangles = mesh.triangles;
  for (Triangle& triangle : result.triangles)
    for (std::uint32_t& v : triangle) {
      if (v >= mesh.vertex_count()) {
        throw InvalidInput(
            fmt::format("a triangle has vertex {}, but there are {}", v, mesh.vertex_count()));
      }
      v = index[v];
    }
  result.triangle_spheres = mesh.triangle_spheres;
  return result;
}

// The mesh itself in buffers that doubled as they grew, the index of each vertex, and the welder's
// hash table, at most half full, beside the one that it was made from.
std::uint64_t welding_bytes(const MeshSize& size) {
  constexpr std::uint64_t kTable = (8 + 2) * 8 + (std::uint64_t{1} << 20);
  const std::uint64_t vertex = 2 * (sizeof(Vec3d) + sizeof(VertexSpheres)) + 4 + (8 + 2) * 8;
  return size.vertices * vertex + size.triangles * (sizeof(Triangle) + 4) + kTable;
}

}  // namespace vdwmesh
