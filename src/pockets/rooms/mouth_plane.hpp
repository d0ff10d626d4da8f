// A triangle of a mouth, and what the walls leave free of it: for the library's own use.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "pockets/rooms/wall_mesh.hpp"

namespace vdwmesh {

// A directed edge between two vertices of a WallMesh.
using Step = std::array<std::uint32_t, 2>;

struct MouthPlane {
  std::uint32_t pocket, part;                 // the part is the number of the mouth, from 1
  std::array<SphereId, 3> balls;              // counter-clockwise seen from outside the pocket
  std::array<Vec3d, 3> corners;               // their centres
  WallPlane plane;                            // the normal points out of the pocket
  double edge_length;                         // Å: longest edge of walls along the rim
  std::vector<SphereId> near = {};            // spheres that may come near the triangle
  std::unordered_set<std::uint32_t> on = {};  // vertices of walls in the triangle
  // The free stretches of the triangle's edges, from corner k towards the next: between vertices.
  std::vector<Step> stretches = {};
  // The edges of walls along the rim, as in the wall's triangle on the pocket's side. The union's
  // triangles face the room, so this is the way of the mouth's own triangles too.
  std::vector<Step> rim = {};

  // Whether a point of the plane is in the triangle.
  bool contains(const Vec3d& p) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d side = corners[(k + 1) % 3] - corners[k];
      if (!(dot(cross(plane.normal, side), p - corners[k]) >= 0)) return false;
    }
    return true;
  }
};

// Cuts the walls along all triangles, whose `on`, `stretches` and `rim` are filled. Returns for
// each triangle whether it could be cut: its rim is then made of closed ways and of ways between
// stretches.
std::vector<std::uint8_t> cut_walls(WallMesh& walls, const SphereSet& spheres,
                                    std::vector<MouthPlane>& planes);

// The triangles of what is free of a mouth's triangle, counter-clockwise from outside: bounded by
// its stretches and by its rim. New vertices within, about `edge_length` apart, are
// added to the walls' vertices. Nothing if rim and stretches do not bound an area.
std::vector<Triangle> fill_mouth(WallMesh& walls, const MouthPlane& mouth, double edge_length);

}  // namespace vdwmesh
