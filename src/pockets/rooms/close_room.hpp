// Makes one closed mesh of triangles of walls and mouths: for the library's own use.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pockets/pocket_meshes.hpp"
#include "pockets/rooms/wall_mesh.hpp"

namespace vdwmesh {

// A triangle of a room, by vertices of the walls; outward, so walls are turned round.
struct RoomTriangle {
  Triangle vertices;
  SphereId sphere;     // kNoSphere: of a mouth
  std::uint32_t part;  // as in PocketMesh
};

// At an edge with more than two triangles, two are neighbours if the room is between them. Vertices
// and edges in which the room touches itself are there several times. Nothing if an edge has no
// other side.
std::optional<PocketMesh> close_room(const WallMesh& walls,
                                     const std::vector<RoomTriangle>& triangles);

}  // namespace vdwmesh
