// Makes the crease-exact mesh of an arrangement from the arcs and corners that boundary_arcs() has
// placed. exact_mesher.cpp calls it, and again with other feature sizes if curves are too close.
#pragma once

#include "creases/arcs/arrangement.hpp"
#include "creases/arcs/boundary_arcs.hpp"
#include "creases/exact_mesher.hpp"
#include "creases/share/mesh_borders.hpp"
#include "creases/share/mesh_team.hpp"
#include "creases/share/patch_device.hpp"

namespace vdwmesh {

// Meshes the boundary, each process of the team its part, and gives that to the team. The mesh
// depends on the arrangement, the boundary and the options alone, not on the number of threads or
// processes. Throws CurvesTooClose, LimitExceeded, Cancelled, in all processes.
// A device, if there is one, meshes the patches once their boundaries are settled.
// `part`: what this process has of the arrangement, if that is of its own balls and those around
// them, and the boundary has the arcs and corners at its own balls alone. Null: the arrangement is
// that of all balls.
ExactMeshStats mesh_boundary(const Arrangement& arrangement, BoundaryArcs&& boundary,
                             const ExactMeshOptions& options, PatchDevice* device, MeshTeam& team,
                             const OwnedPart* part = nullptr);

}  // namespace vdwmesh
