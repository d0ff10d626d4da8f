// Makes a mesh manifold at vertices in which several fans of triangles meet only in the point. At
// joined corners of the boundary, surfaces may meet so.
//
// A fan is a set of triangles around a vertex that are connected by common edges at the vertex. A
// vertex with more than one fan is not manifold. The fan of the first triangle keeps the vertex.
// Each other fan gets a copy of it. The vertex of a fan, kept or copied, has the old label if that
// names all spheres of the fan's triangles. If not, its label has these spheres, if they are three
// at most.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// The corner of a triangle at a vertex.
struct Wedge {
  std::uint64_t triangle;
  std::uint32_t corner;          // of the triangle that is at the vertex, 0 to 2
  SphereId sphere;               // of the triangle
  std::uint64_t next, previous;  // the other two vertices of the triangle
};

// The fans of a vertex, numbered in the order of their first wedges.
struct Fans {
  std::vector<std::uint32_t> of_wedge;  // by wedge, the number of its fan
  std::vector<VertexSpheres> labels;    // by fan, of its vertex
};

// The fans of a vertex with this label, of which all wedges are given.
Fans fans_of(std::span<const Wedge> wedges, const VertexSpheres& label);

// Parts the fans at the first `count` vertices of a mesh. The copies stand at the end of the mesh,
// in the order of the vertices and their fans. If all other vertices are manifold, so is the mesh
// afterwards.
//
// Precondition: the mesh has normals and labels, and `opposite` is empty, because it would not
// follow the change. Throws LimitExceeded past 2^32 vertices.
void split_fans(std::size_t count, IndexedMesh& mesh);

}  // namespace vdwmesh
