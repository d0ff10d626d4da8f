// The half-edge mesh users work with: OpenMesh in double precision, with normals, CPK colours and
// the spheres of every vertex and, where known, of every face.
#pragma once

// GCC 12 takes the uninitialised OpenMesh::Vec3uc that PropertyT::push_back copies for a mistake.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct SurfaceMeshTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3f;
  using Color = OpenMesh::Vec3uc;
  VertexAttributes(OpenMesh::Attributes::Normal | OpenMesh::Attributes::Color |
                   OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge | OpenMesh::Attributes::Status);
};
using SurfaceMesh = OpenMesh::TriMesh_ArrayKernelT<SurfaceMeshTraits>;

// The property that holds VertexSpheres, present in every SurfaceMesh made here.
using VertexSpheresProperty = OpenMesh::VPropHandleT<VertexSpheres>;
VertexSpheresProperty vertex_spheres(const SurfaceMesh& mesh);
inline constexpr const char* kVertexSpheresName = "v:spheres";

// The property that holds the sphere of each face: present where the IndexedMesh had
// triangle_spheres, so that each face is part of one sphere's patch.
using FaceSphereProperty = OpenMesh::FPropHandleT<SphereId>;
std::optional<FaceSphereProperty> face_spheres(const SurfaceMesh& mesh);
inline constexpr const char* kFaceSphereName = "f:sphere";

// Builds the half-edge structure in bulk (no add_face). The input must be closed or have boundary,
// every edge on at most two triangles that run it in opposite directions, every vertex one fan.
// `mesh.opposite` is used where present, else computed. Throws InvalidInput naming the first edge
// or vertex that breaks the rule, LimitExceeded beyond 2^31 - 1 half-edges.
SurfaceMesh to_surface_mesh(const IndexedMesh& mesh);

// The inverse: vertices and faces in handle order, opposite half-edges filled in.
IndexedMesh to_indexed_mesh(const SurfaceMesh& mesh);

// Half-edge opposite to each half-edge 3t + k, kNoOpposite on a boundary. Throws InvalidInput for
// an edge on more than two triangles or run twice in the same direction.
inline constexpr std::uint32_t kNoOpposite = 0xffffffffu;
Buffer<std::uint32_t> opposite_half_edges(std::span<const Triangle> triangles,
                                          std::size_t vertex_count);

// CPK colours by element of each vertex's atom; `elements[i]` is the symbol of sphere i.
void color_by_element(SurfaceMesh& mesh, std::span<const std::string> elements);

}  // namespace vdwmesh
