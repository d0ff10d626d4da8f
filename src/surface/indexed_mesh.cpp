// The arrays of an IndexedMesh as a whole: their bytes, their allocation and their hashes.
//
// The first overload of indexed_mesh_bytes() must count exactly the arrays that make_room()
// allocates, because it serves to check memory limits before make_room() is called. A new array of
// IndexedMesh has to be added to four functions: both overloads of indexed_mesh_bytes(),
// make_room() and hash().
#include "surface/indexed_mesh.hpp"

#include <tbb/parallel_invoke.h>

#include <span>

#include "core/fnv.hpp"
#include "core/large_pages.hpp"

namespace vdwmesh {
namespace {

// The hash of an array of bytes whose beginning had the hash `before`.
template <class T, std::size_t extent>
std::uint64_t hash_bytes(std::span<const T, extent> values, std::uint64_t before) {
  return fnv1a({reinterpret_cast<const char*>(values.data()), values.size_bytes()}, before);
}

template <class T>
std::uint64_t hash_bytes(const Buffer<T>& values) {
  return hash_bytes(std::span<const T>(values), fnv1a({}));
}

// Hashes the label of every vertex as three sphere ids. VertexLabels may store one or three ids per
// vertex (its LabelWidth), and labels[v] returns kNoSphere for ids that are not stored. Meshes with
// equal labels thus have equal hashes, even if only one of them stores its unused ids.
std::uint64_t hash_bytes(const VertexLabels& labels) {
  std::uint64_t hash = fnv1a({});
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const VertexSpheres label = labels[v];
    hash = hash_bytes(std::span<const SphereId>(label), hash);
  }
  return hash;
}

template <class T>
std::uint64_t bytes_of(const Buffer<T>& values) {
  return values.size() * sizeof(T);
}

}  // namespace

std::uint64_t indexed_mesh_bytes(const MeshSize& size, const MeshArrays& arrays) {
  const std::uint64_t per_triangle =
      sizeof(Triangle) +
      (arrays.connectivity == Connectivity::half_edges ? 3 * sizeof(std::uint32_t) : 0) +
      (arrays.labels == TriangleLabels::spheres ? sizeof(SphereId) : 0);
  const std::uint64_t per_vertex = sizeof(Vec3d) + label_bytes(arrays.width) +
                                   (arrays.normals == Normals::gradients ? sizeof(Vec3f) : 0);
  return size.vertices * per_vertex + size.triangles * per_triangle;
}

std::uint64_t indexed_mesh_bytes(const IndexedMesh& m) {
  return bytes_of(m.positions) + bytes_of(m.normals) + bytes_of(m.vertex_spheres.atoms) +
         bytes_of(m.vertex_spheres.others) + bytes_of(m.triangles) + bytes_of(m.triangle_spheres) +
         bytes_of(m.opposite);
}

// resize_untouched() writes no element, but it has the kernel map the small pages at both ends of
// an array (expect_writing()). Nearly all the time goes to such calls of the kernel, so the arrays
// are allocated in parallel.
void make_room(IndexedMesh& mesh, const MeshSize& size, const MeshArrays& arrays) {
  // Returns `count` if the mesh shall have the optional array, and otherwise 0, which empties it.
  const auto where = [](bool there, std::uint64_t count) { return there ? count : 0; };
  const bool has_half_edges = arrays.connectivity == Connectivity::half_edges;
  tbb::parallel_invoke(
      [&] { resize_untouched(mesh.positions, size.vertices); },
      [&] {
        resize_untouched(mesh.normals, where(arrays.normals == Normals::gradients, size.vertices));
      },
      [&] { mesh.vertex_spheres.resize(size.vertices, arrays.width); },
      [&] { resize_untouched(mesh.triangles, size.triangles); },
      [&] {
        resize_untouched(mesh.triangle_spheres,
                         where(arrays.labels == TriangleLabels::spheres, size.triangles));
      },
      [&] { resize_untouched(mesh.opposite, where(has_half_edges, 3 * size.triangles)); });
}

IndexedMeshHash hash(const IndexedMesh& mesh) {
  return {hash_bytes(mesh.positions),        hash_bytes(mesh.normals),
          hash_bytes(mesh.vertex_spheres),   hash_bytes(mesh.triangles),
          hash_bytes(mesh.triangle_spheres), hash_bytes(mesh.opposite)};
}

}  // namespace vdwmesh
