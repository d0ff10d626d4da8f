// The sharp features of an excluded surface: creases between the concave patches of two probes, and
// corners, in which creases end or meet and saddles have their cusps. For the library's own use.
// Everywhere else the surface is smooth across the curves between its patches.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "remesh/dynamic_mesh.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh::remesh {

// What keeps a vertex: nothing, the crease it runs on, or its place.
enum class VertexHold : std::uint8_t { none, crease, corner };

// The circle in which the spheres of two probes meet.
struct CreaseCircle {
  std::array<std::uint32_t, 2> patches;  // ascending
  Vec3d center, axis;                    // Å; unit
  double radius;                         // Å

  // The point of the circle nearest to one that is not on the axis.
  Vec3d nearest(const Vec3d& p) const;
};

struct FeatureGraph {
  // Marks each edge of a crease in `mesh` by its place in `circles`. The mesh must be that of
  // `surface`.
  FeatureGraph(const PatchedMesh& surface, DynamicMesh& mesh);

  std::vector<VertexHold> hold;  // by vertex
  std::vector<CreaseCircle> circles;
  std::uint64_t crease_edges = 0, corners = 0;
};

// What holds a vertex by the marks around it: a crease if two edges of the same one meet in it,
// nothing if there are none, else its place.
VertexHold hold_by_marks(const DynamicMesh& mesh, std::uint32_t vertex);

}  // namespace vdwmesh::remesh
