// Puts patches together into one mesh: the last step of union_mesher.cpp.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "arrangement/complex/power_triangulation.hpp"
#include "arrangement/mesher/mesh_team.hpp"
#include "arrangement/mesher/patch_mesher.hpp"

namespace vdwmesh {

// What a mesh of patches has beside positions, normals and triangles.
inline constexpr MeshArrays kPatchArrays = {.labels = TriangleLabels::spheres,
                                            .width = LabelWidth::three};

// What is put together. The arcs are sampled, their points are numbered, and the patches of the
// balls of `share` are meshed.
struct MeshedPatches {
  const PowerTriangulation& triangulation;
  const BoundaryArcs& boundary;
  const ArcSampling& sampling;
  const PatchIndex& index;
  std::vector<PatchMesh>& patches;  // by ball; each is freed once it is copied
};

// The runs [first, second) of balls, corners and arcs that one process is responsible for.
struct MeshShare {
  using Run = std::pair<std::uint32_t, std::uint32_t>;
  Run balls, corners, arcs;
};

// The vertices are the corners and points of arcs, with the numbers that the sampling has given
// them, then the interior points ball by ball; the triangles come ball by ball. Throws
// LimitExceeded if a piece has more vertices than 32 bits can name.
MeshPiece assemble(const MeshedPatches& meshed, const MeshShare& share);

}  // namespace vdwmesh
