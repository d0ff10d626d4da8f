// The mesh of the spheres' exposed areas, to be cut along the mouths of pockets: for the library's
// own use. Lengths are in Å.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// An edge by its ends, whichever way it runs.
using EdgeKey = std::uint64_t;
inline EdgeKey edge_key(std::uint32_t a, std::uint32_t b) {
  return a < b ? EdgeKey{a} << 32 | b : EdgeKey{b} << 32 | a;
}

// A plane; the normal has length 1.
struct WallPlane {
  Vec3d normal, through;
  double height(const Vec3d& p) const { return dot(normal, p - through); }
};

// Triangles, each of one sphere on which its vertices lie. Triangles are divided and never removed:
// a part keeps the place and the sphere of the whole, the others come behind.
class WallMesh {
 public:
  WallMesh(const SphereSet& spheres, const IndexedMesh& union_mesh);

  std::vector<Vec3d> positions;
  std::vector<VertexSpheres> labels;   // of corners of more than three spheres the first three
  std::vector<std::uint8_t> is_fixed;  // by vertex: it lies on the rim of a mouth
  std::vector<Triangle> triangles;
  std::vector<SphereId> triangle_spheres;
  const std::vector<std::uint32_t>& triangles_of(SphereId sphere) const {
    return of_sphere_[sphere];
  }

  std::uint32_t add_vertex(const Vec3d& position, const VertexSpheres& label);
  // Divides the triangles of the list at the points of their edges.
  // Precondition: all triangles at such an edge are in the list.
  void split(const std::vector<std::uint32_t>& among,
             const std::unordered_map<EdgeKey, std::uint32_t>& points);
  // Divides edges between triangles of the list until none is longer, or for many rounds. New
  // triangles are added to the list. Edges with one triangle in the list stay.
  void divide_longer(std::vector<std::uint32_t>& list, double longest);
  // Divides a triangle in three around a vertex in it.
  void insert(std::uint32_t triangle, std::uint32_t vertex);

  // The place nearest to p, or about so, on the spheres of the label: on one sphere, or on the
  // circle of two. With a plane, where they meet the plane. Nothing if there is none.
  std::optional<Vec3d> onto(const VertexSpheres& label, const Vec3d& p) const;
  std::optional<Vec3d> onto(const VertexSpheres& label, const WallPlane& plane,
                            const Vec3d& p) const;

 private:
  void add_triangle(const Triangle& triangle, SphereId sphere);
  void divide(std::uint32_t triangle, const std::array<std::uint32_t, 3>& middles);

  const SphereSet& spheres_;
  std::vector<std::vector<std::uint32_t>> of_sphere_;  // triangles
};

}  // namespace vdwmesh
