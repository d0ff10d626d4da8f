// A mesh reader on any bytes, and all that `compare` does with what it read. VDWMESH_FUZZ_FORMAT
// names the format.
#include <algorithm>
#include <cmath>

#include "analysis/distances.hpp"
#include "analysis/mesh_measures.hpp"
#include "analysis/quality_histograms.hpp"
#include "fuzz/fuzz_target.hpp"
#include "mesh/mesh_io.hpp"

namespace vdwmesh::fuzz {
namespace {

constexpr MeshFormat kFormat = MeshFormat::VDWMESH_FUZZ_FORMAT;
constexpr std::size_t kMostTriangles = 2000;  // taken further than the sums

void check_arrays(const IndexedMesh& mesh) {
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) require(v < mesh.vertex_count(), "indices are of vertices");
  }
  require(mesh.normals.empty() || mesh.normals.size() == mesh.vertex_count(),
          "normals are of vertices");
  require(mesh.vertex_spheres.empty() || mesh.vertex_spheres.size() == mesh.vertex_count(),
          "labels are of vertices");
  for (const Vec3d& p : mesh.positions) {
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "positions are finite");
  }
}

void measure(const IndexedMesh& mesh) {
  const MeshSummary summary = summarize(mesh);
  require(summary.topology.triangles == mesh.triangle_count(), "triangles are counted");
  quality(mesh);
  quality_histograms(mesh);
  if (mesh.triangle_count() > kMostTriangles) return;
  allow_refusal([&] { self_intersections(mesh); });
  const SphereSet spheres({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}});
  DistanceOptions options;
  const double area = std::max(summary.measures.area, 1.0);
  options.samples_per_area = std::min(10.0, 100 / area);  // few, however large the mesh
  options.memory_limit = std::uint64_t{1} << 28;
  allow_refusal([&] { distances(mesh, spheres, options); });
}

// A half-edge mesh that was written comes back with the same triangles.
void write_and_read(const IndexedMesh& mesh) {
  allow_refusal([&] {
    const SurfaceMesh half_edges = to_surface_mesh(mesh);
    const EncodedMesh file = encode_mesh(half_edges, kFormat);
    const MeshFile back = decode_mesh(file.bytes, kFormat);
    require(back.mesh.triangle_count() == mesh.triangle_count(), "triangles come back");
  });
}

}  // namespace

void run_input(const std::uint8_t* data, std::size_t size) {
  allow_refusal([&] {
    const MeshFile file = decode_mesh(as_text(data, size), kFormat);
    check_arrays(file.mesh);
    if (file.mesh.triangles.empty()) return;
    measure(file.mesh);
    write_and_read(file.mesh);
  });
}

}  // namespace vdwmesh::fuzz
