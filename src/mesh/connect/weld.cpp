// Welding of a whole mesh: a VertexWelder (an exact hash table of positions) maps each vertex to
// the first one at its place, and the triangles are renumbered. `vdwmesh compare` welds a mesh
// if that closes it, since some programs write separate vertices for every triangle.
#include "mesh/connect/weld.hpp"

#include <fmt/format.h>

#include "core/errors.hpp"
#include "mesh/connect/vertex_welder.hpp"

namespace vdwmesh {

IndexedMesh welded(const IndexedMesh& mesh) {
  IndexedMesh result;
  formats::VertexWelder welder(result.positions);
  Buffer<std::uint32_t> index(mesh.vertex_count());
  const VertexLabels& labels = mesh.vertex_spheres;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const std::size_t before = result.vertex_count();
    index[v] = welder.index(mesh.positions[v]);
    // The welder has appended the position to `result` if it is new.
    if (result.vertex_count() == before) continue;  // merged with an earlier vertex
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

// Per vertex: position and label, twice, because buffers grow by doubling; 4 bytes in `index`; and
// the welder's hash table. A slot of the table has 8 bytes. The table grows fourfold when it is
// half full, so it has up to 8 slots per vertex, and while it grows the old one, of 2 slots per
// vertex, exists beside it. Per triangle: its corners and its sphere. kTable is the part that a
// mesh of any size needs: one more vertex in the table, and at most 1 MiB for the tables of initial
// size.
std::uint64_t welding_bytes(const MeshSize& size) {
  constexpr std::uint64_t kTable = (8 + 2) * 8 + (std::uint64_t{1} << 20);
  const std::uint64_t vertex = 2 * (sizeof(Vec3d) + sizeof(VertexSpheres)) + 4 + (8 + 2) * 8;
  return size.vertices * vertex + size.triangles * (sizeof(Triangle) + 4) + kTable;
}

}  // namespace vdwmesh
