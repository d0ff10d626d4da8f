// The half-edge mesh that users of the library work with, and its conversion from and to the
// IndexedMesh of the earlier stages.
//
// A SurfaceMesh is an OpenMesh triangle mesh with double positions (Å), float normals and one
// 8-bit RGB colour per vertex. It also stores which spheres every vertex lies on. If the
// IndexedMesh labels its triangles, the SurfaceMesh stores one sphere per face as well.
#pragma once

// OpenMesh's PropertyT::push_back copies an uninitialised OpenMesh::Vec3uc. That is harmless, but
// GCC 12 warns about it.
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

// Status attributes are needed to delete elements; PrevHalfedge makes the step to the previous
// half-edge O(1).
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

// Handle of the vertex property that holds the VertexSpheres (see surface/vertex_labels.hpp). Every
// SurfaceMesh made by this library has the property. Throws InvalidInput if the mesh has none.
using VertexSpheresProperty = OpenMesh::VPropHandleT<VertexSpheres>;
VertexSpheresProperty vertex_spheres(const SurfaceMesh& mesh);
inline constexpr const char* kVertexSpheresName = "v:spheres";

// Handle of the face property that holds, for each face, the sphere whose patch the face is part
// of. The property exists only if the IndexedMesh had triangle_spheres; otherwise the result is
// empty.
using FaceSphereProperty = OpenMesh::FPropHandleT<SphereId>;
std::optional<FaceSphereProperty> face_spheres(const SurfaceMesh& mesh);
inline constexpr const char* kFaceSphereName = "f:sphere";

// Converts a mesh, building all half-edges in bulk instead of calling add_face() per triangle.
// Precondition: the triangles are an oriented 2-manifold, with or without boundary. So an edge lies
// on at most two triangles, which run along it in opposite directions, and the triangles around a
// vertex are one fan. `mesh.opposite` is checked and used if it is there, and computed if not.
// Throws InvalidInput that names the first edge or vertex that breaks the precondition, and
// LimitExceeded beyond 2^31 - 1 half-edges.
SurfaceMesh to_surface_mesh(const IndexedMesh& mesh);

// A normal for each vertex: the sum of the area vectors of the triangles around it, normalised, so
// large triangles weigh more; zero where there is none.
Buffer<Vec3f> normals_of_triangles(const IndexedMesh& mesh);

// The inverse of to_surface_mesh(): vertices and triangles in the order of their handles, with
// `opposite` filled in. Throws InvalidInput if the mesh lacks the vertex property above or has
// deleted elements.
IndexedMesh to_indexed_mesh(const SurfaceMesh& mesh);

// Throws InvalidInput that names the first deleted face or vertex. OpenMesh only marks deleted
// elements; its garbage_collection() removes them and renumbers the rest.
void check_nothing_deleted(const SurfaceMesh& mesh);

// The opposite of each half-edge 3t + k, which is the half-edge that runs back along the same edge,
// or kNoOpposite if the edge is on the boundary. Throws InvalidInput if an edge lies on more than
// two triangles or two triangles run along it in the same direction.
inline constexpr std::uint32_t kNoOpposite = 0xffffffffu;
Buffer<std::uint32_t> opposite_half_edges(std::span<const Triangle> triangles,
                                          std::size_t vertex_count);

// Gives each vertex the CPK colour of its atom, the first of its spheres. `elements[i]` is the
// chemical symbol of sphere i. A vertex without an atom keeps its colour. Throws InvalidInput if a
// vertex names a sphere beyond the end of `elements`.
void color_by_element(SurfaceMesh& mesh, std::span<const std::string> elements);

}  // namespace vdwmesh
