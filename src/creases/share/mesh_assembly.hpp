// Puts the mesh of a union together, once all patches are meshed and all arcs are sampled.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "creases/patch/patch_mesher.hpp"
#include "creases/share/mesh_placement.hpp"
#include "creases/share/mesh_team.hpp"

namespace vdwmesh {

class PatchDispatch;

// What the rounds of meshing have left. Keeps references.
struct MeshedPatches {
  const PlacedBalls& balls;
  const ArcSampling& sampling;      // with numbered vertices
  std::span<PatchMesh> patches;     // by ball; empty for balls without, and for those of the device
  PatchDispatch* device = nullptr;  // if there is one
  // By ball: what the rounds needed. It is freed while a device writes.
  std::span<std::unique_ptr<PatchProgress>> progress;
};

// Builds the piece of this process. Its vertices are corners and points of arcs, as the sampling
// has numbered them, then the interior points ball by ball; the patches of other processes are
// empty here. The patches of the host are empty afterwards. If `stays_on_device`, the device has
// the mesh, and that of the piece is empty; this process is alone then. Throws LimitExceeded for
// too many vertices.
UnnumberedPiece assemble(MeshPlacement& placement, const MeshedPatches& meshed,
                         bool stays_on_device);

}  // namespace vdwmesh
