// IndexedMesh: its bytes and its hash.
#include "surface/indexed_mesh.hpp"

#include <gtest/gtest.h>

namespace vdwmesh {
namespace {

constexpr std::uint64_t kFnvOffset = 14695981039346656037ull;  // FNV-1a, 64 bits, of no bytes

IndexedMesh one_triangle() {
  IndexedMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals.assign(3, {0, 0, 1});
  mesh.vertex_spheres.assign(3, on_sphere(0));
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

template <class T>
std::uint64_t bytes_of(const Buffer<T>& values) {
  return values.size() * sizeof(T);
}

TEST(IndexedMesh, BytesAreThoseOfItsArrays) {
  IndexedMesh mesh = one_triangle();
  mesh.opposite = {2, 1, 0};
  mesh.triangle_spheres = {7};
  const std::uint64_t plain = bytes_of(mesh.positions) + bytes_of(mesh.normals) +
                              bytes_of(mesh.vertex_spheres.atoms) + bytes_of(mesh.triangles);
  constexpr MeshSize size{3, 1};
  EXPECT_EQ(indexed_mesh_bytes(size), plain);
  EXPECT_EQ(indexed_mesh_bytes(size, {.normals = Normals::none}), plain - bytes_of(mesh.normals));
  EXPECT_EQ(indexed_mesh_bytes(size, {.connectivity = Connectivity::half_edges}),
            plain + bytes_of(mesh.opposite));
  EXPECT_EQ(indexed_mesh_bytes(size, {.labels = TriangleLabels::spheres}),
            plain + bytes_of(mesh.triangle_spheres));
  mesh.vertex_spheres.widen();
  EXPECT_EQ(indexed_mesh_bytes(size, {.width = LabelWidth::three}),
            plain + bytes_of(mesh.vertex_spheres.others));
  EXPECT_EQ(indexed_mesh_bytes(mesh),
            indexed_mesh_bytes(size, {.connectivity = Connectivity::half_edges,
                                      .labels = TriangleLabels::spheres,
                                      .width = LabelWidth::three}));
}

TEST(IndexedMesh, RoomIsMadeForWhatIsAskedFor) {
  constexpr MeshSize size{5, 7};
  const MeshArrays few{.normals = Normals::none, .width = LabelWidth::none};
  const MeshArrays all{.connectivity = Connectivity::half_edges,
                       .labels = TriangleLabels::spheres,
                       .width = LabelWidth::three};
  for (const MeshArrays& arrays : {few, MeshArrays{}, all}) {
    IndexedMesh mesh;
    make_room(mesh, size, arrays);
    EXPECT_EQ(mesh.vertex_count(), 5u);
    EXPECT_EQ(mesh.triangle_count(), 7u);
    EXPECT_EQ(mesh.vertex_spheres.width(), arrays.width);
    EXPECT_EQ(mesh.triangle_labels(), arrays.labels);
    EXPECT_EQ(mesh.normals.empty(), arrays.normals == Normals::none);
    EXPECT_EQ(indexed_mesh_bytes(mesh), indexed_mesh_bytes(size, arrays));
  }
}

TEST(IndexedMesh, HashOfNoTriangleSpheresIsThatOfNoBytes) {
  EXPECT_EQ(hash(one_triangle()).triangle_spheres, kFnvOffset);
}

TEST(IndexedMesh, HashSeesTriangleSpheresApart) {
  IndexedMesh a = one_triangle(), b = one_triangle();
  a.triangle_spheres = {1};
  b.triangle_spheres = {2};
  EXPECT_NE(hash(a), hash(b));
  EXPECT_EQ(hash(a).vertex_spheres, hash(b).vertex_spheres);
  EXPECT_EQ(hash(a).triangles, hash(b).triangles);
  a.triangle_spheres = {2};
  EXPECT_EQ(hash(a), hash(b));
}

TEST(IndexedMesh, HashSeesHalfEdgesApart) {
  IndexedMesh a = one_triangle(), b = one_triangle();
  a.opposite = {2, 1, 0};
  b.opposite = {1, 2, 0};
  EXPECT_NE(hash(a), hash(b));
  EXPECT_EQ(hash(a).triangles, hash(b).triangles);
  b.opposite = {2, 1, 0};
  EXPECT_EQ(hash(a), hash(b));
}

TEST(IndexedMesh, HashSeesLabelsNotTheirRoom) {
  IndexedMesh a = one_triangle(), b = one_triangle();
  b.vertex_spheres.widen();
  EXPECT_EQ(hash(a), hash(b));
  b.vertex_spheres.set(2, {0, 1, kNoSphere});
  EXPECT_NE(hash(a).vertex_spheres, hash(b).vertex_spheres);
}

}  // namespace
}  // namespace vdwmesh
