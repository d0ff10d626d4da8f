// Triangles by index, as every stage before OpenMesh passes them on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>

#include "core/buffer.hpp"
#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"
#include "surface/vertex_labels.hpp"

namespace vdwmesh {

using Triangle = std::array<std::uint32_t, 3>;

struct MeshSize {
  std::uint64_t vertices = 0, triangles = 0;
};

// Hears how large a mesh will be before it is there.
using MeshSizeObserver = std::function<void(const MeshSize&)>;

// Whether `triangle_spheres` is filled.
enum class TriangleLabels : std::uint8_t { none, spheres };

// Triangles wind counter-clockwise seen from outside. Half-edge 3t + k of triangle t runs from
// its vertex k to vertex (k + 1) % 3.
struct IndexedMesh {
  Buffer<Vec3d> positions;      // Å
  Buffer<Vec3f> normals;        // unit, outward; empty, or one per vertex
  VertexLabels vertex_spheres;  // empty, or one per vertex
  Buffer<Triangle> triangles;
  // Empty, or one per triangle: the sphere whose patch it is part of. Crease-exact meshes have it:
  // every vertex lies on the spheres of all triangles around it. Marching cubes leaves it empty.
  Buffer<SphereId> triangle_spheres;
  Buffer<std::uint32_t> opposite;  // empty, or one per half-edge: the half-edge that runs back

  std::size_t vertex_count() const { return positions.size(); }
  std::size_t triangle_count() const { return triangles.size(); }
  TriangleLabels triangle_labels() const {
    return triangle_spheres.empty() ? TriangleLabels::none : TriangleLabels::spheres;
  }
};

// Most vertices an IndexedMesh can hold.
inline constexpr std::uint64_t kMaxVertices = std::uint64_t{1} << 32;

// Most half-edges that `opposite` can number.
inline constexpr std::uint64_t kMaxHalfEdges = (std::uint64_t{1} << 32) - 1;

// Whether `opposite` is filled as well.
enum class Connectivity : std::uint8_t { triangles, half_edges };

// Whether `normals` is filled: with those of the field's gradient.
enum class Normals : std::uint8_t { none, gradients };

// A limit of so many bytes is none.
inline constexpr std::uint64_t kNoMemoryLimit = std::numeric_limits<std::uint64_t>::max();

// What a mesh has beside positions and triangles.
struct MeshArrays {
  Connectivity connectivity = Connectivity::triangles;
  TriangleLabels labels = TriangleLabels::none;
  Normals normals = Normals::gradients;
  LabelWidth width = LabelWidth::one;
};

// Bytes of the arrays.
std::uint64_t indexed_mesh_bytes(const MeshSize& size, const MeshArrays& arrays = {});
std::uint64_t indexed_mesh_bytes(const IndexedMesh& mesh);

// Gives a mesh its arrays, which have to be written in full.
void make_room(IndexedMesh& mesh, const MeshSize& size, const MeshArrays& arrays);

// A hash over all bits of all arrays (FNV-1a, 64 bits, array by array): equal for equal meshes.
struct IndexedMeshHash {
  std::uint64_t positions, normals, vertex_spheres, triangles, triangle_spheres, opposite;
  friend bool operator==(const IndexedMeshHash&, const IndexedMeshHash&) = default;
};
IndexedMeshHash hash(const IndexedMesh& mesh);

}  // namespace vdwmesh
