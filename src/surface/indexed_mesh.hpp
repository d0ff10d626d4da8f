// IndexedMesh: vertices, and triangles as triples of vertex indices.
//
// All stages that make or refine a mesh pass it on in this form. Only the stage `mesh` converts it
// into the half-edge structure of OpenMesh. Connectivity (`opposite`) and labels are optional
// arrays; an empty array means that the mesh does not have them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "core/buffer.hpp"
#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"
#include "surface/vertex_labels.hpp"

namespace vdwmesh {

using Triangle = std::array<std::uint32_t, 3>;  // vertex indices

struct MeshSize {
  std::uint64_t vertices = 0, triangles = 0;
};

// A mesher calls this callback with the size of the mesh as soon as it knows the size, before it
// allocates the arrays.
using MeshSizeObserver = std::function<void(const MeshSize&)>;

// Whether IndexedMesh::triangle_spheres is filled.
enum class TriangleLabels : std::uint8_t { none, spheres };

// The vertices of a triangle are in counter-clockwise order for a viewer outside the surface.
// Half-edge 3t + k of triangle t runs from its vertex k to its vertex (k + 1) % 3.
struct IndexedMesh {
  Buffer<Vec3d> positions;      // Å
  Buffer<Vec3f> normals;        // unit, outward; empty, or one per vertex
  VertexLabels vertex_spheres;  // empty, or one per vertex
  Buffer<Triangle> triangles;
  // Empty, or one per triangle: the id of the sphere whose patch the triangle is part of.
  // Crease-exact meshes have this array, and every vertex of such a mesh lies on the spheres of all
  // triangles around it. Marching cubes leaves the array empty.
  Buffer<SphereId> triangle_spheres;
  // Empty, or one per half-edge: the index of the opposite half-edge, which runs along the same
  // edge in the other direction.
  Buffer<std::uint32_t> opposite;

  std::size_t vertex_count() const { return positions.size(); }
  std::size_t triangle_count() const { return triangles.size(); }
  TriangleLabels triangle_labels() const {
    return triangle_spheres.empty() ? TriangleLabels::none : TriangleLabels::spheres;
  }
};

// The largest number of vertices: indices are 32 bits wide.
inline constexpr std::uint64_t kMaxVertices = std::uint64_t{1} << 32;

// The largest number of half-edges for which `opposite` can be filled. It is one less than 2^32, so
// that the value 2^32 - 1 can mean "no opposite half-edge".
inline constexpr std::uint64_t kMaxHalfEdges = (std::uint64_t{1} << 32) - 1;

// Whether IndexedMesh::opposite is filled: `triangles` means that it is empty.
enum class Connectivity : std::uint8_t { triangles, half_edges };

// Whether IndexedMesh::normals is filled. Each normal is the unit normal of a level set of the
// field, computed from the field's gradient.
enum class Normals : std::uint8_t { none, gradients };

// How a mesh is made of spheres: on a grid (extract/), or along the creases between them
// (creases/).
enum class Mesher : std::uint8_t { marching_cubes, exact };

// Which optional arrays a mesh has beside positions and triangles. `width` is the width of
// IndexedMesh::vertex_spheres, in ids per vertex.
struct MeshArrays {
  Connectivity connectivity = Connectivity::triangles;
  TriangleLabels labels = TriangleLabels::none;
  Normals normals = Normals::gradients;
  LabelWidth width = LabelWidth::one;
};

// The bytes of all arrays: of a mesh of this size with these optional arrays, and of an existing
// mesh.
std::uint64_t indexed_mesh_bytes(const MeshSize& size, const MeshArrays& arrays = {});
std::uint64_t indexed_mesh_bytes(const IndexedMesh& mesh);

// Resizes positions, triangles and the optional arrays that `arrays` names, and empties all other
// arrays. New elements are uninitialised; the caller must write all elements.
void make_room(IndexedMesh& mesh, const MeshSize& size, const MeshArrays& arrays);

// One 64-bit hash (FNV-1a) for each array, over all its bits; for the labels, over all three ids of
// every vertex, stored or not. Meshes that are equal bit for bit have equal hashes.
struct IndexedMeshHash {
  std::uint64_t positions, normals, vertex_spheres, triangles, triangle_spheres, opposite;
  friend bool operator==(const IndexedMeshHash&, const IndexedMeshHash&) = default;
};
IndexedMeshHash hash(const IndexedMesh& mesh);

}  // namespace vdwmesh
