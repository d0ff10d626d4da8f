// The edge length that is wanted at each vertex. For the library's own use.
#pragma once

#include <vector>

#include "remesh/feature_graph.hpp"

namespace vdwmesh::remesh {

// At most `edge_length`, Å; shorter around thin waists of saddles and between near corners, from
// where lengths grow by kSlope of the way.
std::vector<double> edge_lengths(const PatchedMesh& surface, const DynamicMesh& mesh,
                                 const FeatureGraph& features, double edge_length);

// Features nearer to each other than this share of the edge length may join.
inline constexpr double kJoining = 0.4;

}  // namespace vdwmesh::remesh
