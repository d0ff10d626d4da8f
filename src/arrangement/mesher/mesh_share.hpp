// Which part of a mesh one process makes, and whether it has the memory for it.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "arrangement/exact_mesher.hpp"
#include "arrangement/mesher/boundary_arcs.hpp"
#include "arrangement/mesher/mesh_team.hpp"

namespace vdwmesh {

// What a mesh of patches has beside positions, normals and triangles.
inline constexpr MeshArrays kPatchArrays = {.labels = TriangleLabels::spheres,
                                            .width = LabelWidth::three};

// The runs [first, second) of balls, corners and arcs that one process has.
struct MeshShare {
  using Run = std::pair<std::uint32_t, std::uint32_t>;
  Run balls, corners, arcs;

  // Whether the process meshes the ball's patch.
  bool has_patch_of(std::uint32_t ball) const { return ball >= balls.first && ball < balls.second; }
};

// The edge length of each ball, scaled as the triangulation.
std::vector<double> scaled_edge_lengths(const PlacedBalls& balls, const ExactMeshOptions& options);

// The areas of patches, and the edge lengths wanted there, by ball and in one unit.
struct PatchExtents {
  std::span<const double> areas, edge_lengths;
};

// The share of this process of the team: all, if it is alone.
MeshShare own_share(const MeshTeam& team, const BoundaryArcs& boundary,
                    const PatchExtents& patches);

// Refuses a share that will not fit the memory limit, before its memory is taken; `pieces` is how
// many pieces of arcs it has. Throws LimitExceeded.
void check_memory(const MeshShare& share, const PatchExtents& patches, std::uint64_t pieces,
                  const ExactMeshOptions& options);

// Throws LimitExceeded if a mesh cannot hold so many vertices.
void check_vertices(std::uint64_t vertices);

}  // namespace vdwmesh
