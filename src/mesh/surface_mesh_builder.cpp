// Builds a SurfaceMesh from an IndexedMesh, the source, in five steps: check the sizes of all
// arrays; find the opposite half-edges unless the source has them; wait for the arrays that
// prepare() started to allocate; link the half-edges (connectivity.cpp); copy positions, normals
// and labels on all cores. to_surface_mesh() is this builder without prepare().
#include "mesh/surface_mesh_builder.hpp"

#include <fmt/format.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <span>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "mesh/connectivity.hpp"
#include "mesh/element_color.hpp"
#include "mesh/half_edge_limit.hpp"
#include "mesh/surface_handles.hpp"
#include "mesh/surface_room.hpp"
#include "surface/triangle_check.hpp"

namespace vdwmesh {
namespace {

using handles::face;
using handles::vertex;
// Until color_by_element() or the user sets another colour.
const SurfaceMesh::Color kFirstColor{kPlainColor[0], kPlainColor[1], kPlainColor[2]};

// OpenMesh's handles are of type int, which limits vertices and half-edges alike.
void check_limits(std::size_t vertices, std::size_t triangles) {
  constexpr auto kMaxHandle = static_cast<std::size_t>(std::numeric_limits<int>::max());
  if (vertices > kMaxHandle || triangles > kMaxSurfaceHalfEdges / 3)
    throw LimitExceeded(
        fmt::format("{} vertices and {} triangles are more than OpenMesh's {} half-edges can "
                    "hold; a coarser spacing makes fewer",
                    vertices, triangles, kMaxSurfaceHalfEdges));
}

// The unit vector along a, or zero if a is zero or not a number.
SurfaceMesh::Normal unit(const Vec3d& a) {
  const double length = norm(a);
  if (!(length > 0)) return {0, 0, 0};
  return {static_cast<float>(a.x / length), static_cast<float>(a.y / length),
          static_cast<float>(a.z / length)};
}

// Computes vertex normals for a mesh that has none. A normal is the sum of the area vectors of the
// triangles around the vertex, normalised, so large triangles weigh more. The sums run on one
// thread, because threads could add to the same vertex at the same time. Their order, and so the
// result, is always the same.
void set_normals_of_triangles(SurfaceMesh& mesh, const IndexedMesh& source) {
  Buffer<Vec3d> sums(source.vertex_count());
  std::fill(sums.begin(), sums.end(), Vec3d{0, 0, 0});
  for (const auto& [a, b, c] : source.triangles) {
    const Vec3d area =
        cross(source.positions[b] - source.positions[a], source.positions[c] - source.positions[a]);
    for (const std::uint32_t v : {a, b, c}) sums[v] = sums[v] + area;
  }
  for_each_index(sums.size(), [&](std::size_t v) { mesh.set_normal(vertex(v), unit(sums[v])); });
}

void set_vertex_data(SurfaceMesh& mesh, const IndexedMesh& source, VertexSpheresProperty spheres) {
  for_each_index(source.vertex_count(), [&](std::size_t v) {
    const Vec3d& p = source.positions[v];
    mesh.set_point(vertex(v), {p.x, p.y, p.z});
    mesh.set_color(vertex(v), kFirstColor);
    if (!source.normals.empty()) {
      const Vec3f& n = source.normals[v];
      mesh.set_normal(vertex(v), {n.x, n.y, n.z});
    }
    mesh.property(spheres, vertex(v)) =
        source.vertex_spheres.empty() ? on_sphere(kNoSphere) : source.vertex_spheres[v];
  });
  if (source.normals.empty()) set_normals_of_triangles(mesh, source);
}

// Adds the face property of face_spheres() if the source labels its triangles.
void set_face_data(SurfaceMesh& mesh, const IndexedMesh& source) {
  if (source.triangle_labels() == TriangleLabels::none) return;
  FaceSphereProperty spheres;
  mesh.add_property(spheres, kFaceSphereName);
  for_each_index(source.triangle_count(), [&](std::size_t t) {
    mesh.property(spheres, face(t)) = source.triangle_spheres[t];
  });
}

}  // namespace

// A call of make_room() that runs as a TBB task. The destructor waits for the task, so the mesh is
// never destroyed under it. An exception in the task is kept for wait().
class SurfaceMeshBuilder::Room {
 public:
  Room(SurfaceMesh& mesh, const ElementCounts& counts) {
    task_.run([this, &mesh, counts] {
      try {
        make_room(mesh, counts);
      } catch (...) {
        failure_ = std::current_exception();
      }
    });
  }
  ~Room() { task_.wait(); }
  Room(const Room&) = delete;
  Room& operator=(const Room&) = delete;

  // Returns when the arrays are there. Rethrows what make_room() threw.
  void wait() {
    task_.wait();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  tbb::task_group task_;
  std::exception_ptr failure_;
};

SurfaceMeshBuilder::SurfaceMeshBuilder(SurfaceMesh& mesh) : mesh_(mesh) {
  VertexSpheresProperty spheres;
  mesh_.add_property(spheres, kVertexSpheresName);
}

SurfaceMeshBuilder::~SurfaceMeshBuilder() = default;

void SurfaceMeshBuilder::prepare(const MeshSize& size) {
  if (room_) return;
  check_limits(size.vertices, size.triangles);
  // Every triangle has three edges, and in a closed mesh two triangles share each of them.
  room_ = std::make_unique<Room>(
      mesh_, ElementCounts{size.vertices, 3 * size.triangles / 2, size.triangles});
}

SurfaceMesh& SurfaceMeshBuilder::build(const IndexedMesh& source) {
  check_limits(source.vertex_count(), source.triangle_count());
  check_array_sizes(source);
  const bool given = !source.opposite.empty();
  Buffer<std::uint32_t> computed;
  if (!given) computed = opposite_half_edges(source.triangles, source.vertex_count());
  // Until here the background task and the search for opposites run side by side.
  if (room_) room_->wait();
  connect(mesh_, source.triangles, given ? std::span(source.opposite) : std::span(computed),
          source.vertex_count(), given ? Opposites::given : Opposites::computed);
  set_vertex_data(mesh_, source, vertex_spheres(mesh_));
  set_face_data(mesh_, source);
  return mesh_;
}

}  // namespace vdwmesh
