// Estimates of the peak memory of the stages behind a mesh.
//
// Arrays of this project are counted: their element sizes times their lengths, at the moment when
// the arrays that exist together take the most bytes. Memory that cannot be counted so, in CGAL and
// in arrays whose lengths depend on the molecule, was measured. A closed mesh is assumed: it has
// three half-edges per triangle and half as many edges.
#include "analysis/survey/stage_bytes.hpp"

#include <tbb/task_arena.h>

#include <algorithm>

#include "analysis/crossings/facet_tree.hpp"
#include "analysis/distances/distances_tree.hpp"
#include "analysis/survey/quality_parts.hpp"
#include "core/vec3.hpp"
#include "mesh/connect/edge_buckets.hpp"
#include "mesh/connect/groups_by_range.hpp"
#include "mesh/surface_mesh.hpp"

namespace vdwmesh {
namespace {

constexpr std::uint64_t kIndex = sizeof(std::uint32_t);

// The arrays of EdgeBuckets, the half-edges grouped by edge: an offset per vertex and an entry per
// half-edge.
std::uint64_t edge_buckets_bytes(const MeshSize& m) {
  return m.vertices * kIndex + 3 * m.triangles * sizeof(EdgeEntry);
}
// The additional array while EdgeBuckets are filled: the half-edges, grouped by ranges of vertices.
std::uint64_t edge_buckets_scratch(const MeshSize& m) { return 3 * m.triangles * kIndex; }

}  // namespace

std::uint64_t surface_mesh_bytes(const MeshSize& m, Connectivity given) {
  using Kernel = SurfaceMesh;
  const std::uint64_t edges = 3 * m.triangles / 2;
  const std::uint64_t vertex = sizeof(Kernel::Vertex) + sizeof(Kernel::Point) +
                               sizeof(Kernel::Normal) + sizeof(Kernel::Color) +
                               sizeof(OpenMesh::Attributes::StatusInfo) + sizeof(VertexSpheres);
  // Three times StatusInfo: of the edge and of its two half-edges.
  const std::uint64_t edge = sizeof(Kernel::Edge) + 3 * sizeof(OpenMesh::Attributes::StatusInfo);
  const std::uint64_t face =
      sizeof(Kernel::Face) + sizeof(OpenMesh::Attributes::StatusInfo) + sizeof(SphereId);
  const std::uint64_t mesh = m.vertices * vertex + edges * edge + m.triangles * face;
  // If the input has no array of opposite half-edges, the stage computes one.
  const std::uint64_t opposite = given == Connectivity::half_edges ? 0 : 3 * m.triangles * kIndex;
  // Two more arrays exist while OpenMesh's half-edges are made: the new number of each half-edge,
  // and one outgoing half-edge of each vertex.
  const std::uint64_t handles = 3 * m.triangles * kIndex + m.vertices * kIndex;
  return std::max(edge_buckets_bytes(m) + edge_buckets_scratch(m), mesh + handles) + opposite;
}

std::uint64_t measures_bytes(const MeshSize& m) {
  // The union-find over vertices exists through the whole survey. First there is the list of
  // triangles by ranges of vertices: one to three entries for each, 1.3 in meshes of the meshers.
  // Then the shell of each triangle, and a number for each vertex.
  const std::uint64_t connected = m.vertices * kIndex;
  const std::uint64_t by_range = 3 * m.triangles / 2 * kIndex;
  const std::uint64_t shells = m.triangles * kIndex + m.vertices * kIndex;
  // Of two values of each triangle, or of one of each edge, a tenth is kept for the percentiles, or
  // all if the triangles are few; they are copied once, from arrays that may have grown to twice
  // their size. Every thread has the corners, edges and lengths of a range of vertices.
  constexpr std::uint64_t kScratch = std::uint64_t{9} << 18;
  const std::uint64_t values = 2 * m.triangles * sizeof(double);
  const std::uint64_t kept = m.triangles < kFewTriangles ? 3 * values : 3 * values / 10;
  const auto threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
  const std::uint64_t ranges = (m.vertices + kVerticesPerRange - 1) / kVerticesPerRange;
  return connected + std::max(by_range, shells) + kept + kScratch * std::min(threads, ranges);
}

std::uint64_t measures_of_soup_bytes(const MeshSize& m) {
  // When the survey has found no closed manifold, there are union-find arrays of triangles and of
  // corners, and the shell of each triangle, beside the buckets of edges: 1 + 3 + 1 indices per
  // triangle.
  const std::uint64_t survey = (1 + 3 + 1) * m.triangles * kIndex;
  return m.vertices * kIndex + edge_buckets_bytes(m) + std::max(edge_buckets_scratch(m), survey);
}

// Of a divided mesh, the tree as it is kept (18 bytes per triangle), the fans of its vertices and
// the corners of its patches (one byte and three) take a little more than building the tree. The
// edges of a grid (cell_pairs.hpp), 8 bytes per vertex, are less, and are freed before.
std::uint64_t self_intersections_bytes(const MeshSize& m) {
  return FacetTree::bytes(m.triangles) + 2 * m.triangles;
}

std::uint64_t union_bytes(std::uint64_t spheres, UnionMethod method, double exposed) {
  // Bytes per sphere of the triangulation, as a straight line in the exposed share of the area:
  // kBuried - kLessExposed · exposed, but at least kLeast. Measured on the structure 6ZU5: 1580
  // without a probe, where 36 % is exposed, and 2710 with a probe of 1.4 Å, where 4 % is. The line
  // is 2800 with the probe, but 1290 without: it is too low there (docs/notes/robustness.md). kArcs
  // is bytes per sphere of the method `arcs`.
  constexpr double kLeast = 900, kBuried = 3000, kLessExposed = 4700;
  constexpr std::uint64_t kArcs = 400;
  if (method == UnionMethod::arcs) return spheres * kArcs;
  return spheres * static_cast<std::uint64_t>(std::max(kLeast, kBuried - kLessExposed * exposed));
}

std::uint64_t distances_bytes(const MeshSize& m, std::uint64_t spheres) {
  // The patches and the cell list of ExposedSurface. Measured on molecules, as means: a patch has 6
  // covers and 8 corners without a probe. With a probe of 1.4 Å it has 20 covers and 7 corners, and
  // two thirds of the spheres have a patch.
  constexpr std::uint64_t kBytesPerSphere = 800;
  // The tree of a divided mesh has runs of four triangles and takes less than one of triangles.
  // Beside it there is one byte for each vertex, which says whether a triangle uses it.
  return BoxTree::bytes(m.triangles) + m.vertices + kBytesPerSphere * spheres;
}

}  // namespace vdwmesh
