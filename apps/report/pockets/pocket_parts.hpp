// Meshes of pockets with names for their parts, for write_meshes().
#pragma once

#include <vector>

#include "mesh/mesh_io.hpp"
#include "pockets/pocket_meshes.hpp"

namespace vdwmesh::apps {

// "pocket 1" with the parts "pocket 1 wall", "pocket 1 mouth 1" and so on, by rank in the table.
// Walls are translucent, each pocket in a colour of its own, and mouths nearly clear. Pockets
// without a mesh are left out.
std::vector<NamedMesh> named_meshes(std::vector<PocketMesh> meshes);

}  // namespace vdwmesh::apps
