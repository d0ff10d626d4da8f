#include "analysis/stage_bytes.hpp"

#include <algorithm>

#include "analysis/distances_tree.hpp"
#include "core/vec3.hpp"
#include "mesh/edge_buckets.hpp"
#include "mesh/surface_mesh.hpp"

namespace vdwmesh {
namespace {

constexpr std::uint64_t kIndex = sizeof(std::uint32_t);

std::uint64_t edge_buckets_bytes(const MeshSize& m) {
  return m.vertices * kIndex + 3 * m.triangles * sizeof(EdgeEntry);
}
// And while they are filled: the half-edges of each range.
std::uint64_t edge_buckets_scratch(const MeshSize& m) { return 3 * m.triangles * kIndex; }

}  // namespace

std::uint64_t surface_mesh_bytes(const MeshSize& m, Connectivity given) {
  using Kernel = SurfaceMesh;
  const std::uint64_t edges = 3 * m.triangles / 2;
  const std::uint64_t vertex = sizeof(Kernel::Vertex) + sizeof(Kernel::Point) +
                               sizeof(Kernel::Normal) + sizeof(Kernel::Color) +
                               sizeof(OpenMesh::Attributes::StatusInfo) + sizeof(VertexSpheres);
  const std::uint64_t edge =
      sizeof(Kernel::Edge) + 3 * sizeof(OpenMesh::Attributes::StatusInfo);  // two half-edges
  const std::uint64_t face =
      sizeof(Kernel::Face) + sizeof(OpenMesh::Attributes::StatusInfo) + sizeof(SphereId);
  const std::uint64_t mesh = m.vertices * vertex + edges * edge + m.triangles * face;
  const std::uint64_t opposite = given == Connectivity::half_edges ? 0 : 3 * m.triangles * kIndex;
  const std::uint64_t handles = 3 * m.triangles * kIndex + m.vertices * kIndex;
  return std::max(edge_buckets_bytes(m) + edge_buckets_scratch(m), mesh + handles) + opposite;
}

std::uint64_t measures_bytes(const MeshSize& m) {
  // Sets of triangles and of corners, and the shell of each triangle; less where all is closed.
  const std::uint64_t survey = (1 + 3 + 1) * m.triangles * kIndex;
  const std::uint64_t lengths = 3 * m.triangles / 2 * sizeof(double);
  return edge_buckets_bytes(m) + std::max({edge_buckets_scratch(m), survey, lengths});
}

std::uint64_t self_intersections_bytes(const MeshSize& m) {
  constexpr std::uint64_t kBoxes = 175;  // of CGAL, and the lists that it parts them into; measured
  return m.triangles * kBoxes;
}

std::uint64_t union_bytes(std::uint64_t spheres, UnionMethod method, double exposed) {
  // Measured on 6ZU5: 1220 where a third is exposed, 2490 with a probe of 1.4 Å, where 6 % is.
  constexpr double kLeast = 900, kBuried = 3000, kLessExposed = 4700;
  constexpr std::uint64_t kArcs = 400;
  if (method == UnionMethod::arcs) return spheres * kArcs;
  return spheres * static_cast<std::uint64_t>(std::max(kLeast, kBuried - kLessExposed * exposed));
}

std::uint64_t distances_bytes(const MeshSize& m, std::uint64_t spheres) {
  // Measured on molecules: 6 covers and 8 corners without a probe, 20 and 7 with one of 1.4 Å on
  // two thirds of the spheres; and the cell list.
  constexpr std::uint64_t kBytesPerSphere = 800;
  return BoxTree::bytes(m.triangles) + m.vertices + kBytesPerSphere * spheres;
}

}  // namespace vdwmesh
