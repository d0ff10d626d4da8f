// What a triangle mesh is, found the plain way.
#pragma once

#include <string>

#include "reference/point.hpp"

namespace vdwmesh::reference {

struct MeshFacts {
  std::size_t vertices = 0, edges = 0, triangles = 0;
  std::size_t open_edges = 0;            // undirected edges on one triangle
  std::size_t crowded_edges = 0;         // on more than two
  std::size_t badly_oriented_edges = 0;  // on two that run it the same way
  std::size_t split_vertices = 0;        // whose triangles are not one closed fan
  std::size_t unused_vertices = 0;
  std::size_t degenerate_triangles = 0;  // repeated index, or area of exactly 0
  std::size_t bad_numbers = 0;           // coordinates not finite, indices out of range
  std::size_t positive_shells = 0, negative_shells = 0;  // by signed volume
  double area = 0, volume = 0;                           // Å², Å³; volume by orientation
  double angle_defect = 0;                               // sum over the vertices of 2 pi - angles

  bool closed_oriented_manifold() const;
  std::int64_t euler_characteristic() const;
  std::int64_t genus() const;  // shells - chi / 2
  std::string summary() const;
};

// Volumes are taken about the mesh's first vertex, so a mesh far from the origin loses no digits.
MeshFacts inspect(const TriangleMesh& mesh);

}  // namespace vdwmesh::reference
