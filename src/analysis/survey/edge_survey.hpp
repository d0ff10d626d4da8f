// The topological properties of a triangle soup that follow from its edges. topology() and
// measures() in mesh_measures.cpp both need them.
#pragma once

#include <cstdint>

#include "analysis/distances/distribution.hpp"
#include "core/buffer.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct EdgeSurvey {
  bool closed, manifold, oriented;  // as in MeshTopology
  std::uint64_t edges;
  std::uint64_t used_vertices;  // vertices that are on some triangle
  std::uint32_t shells;         // number of pieces that are connected across edges
  // The shell of each triangle. Shells are numbered from 0 in the order of their first triangles.
  Buffer<std::uint32_t> shell_of;
};

// If `edge_lengths` is given, it gets the length of each edge, once, in Å. Throws as survey_part()
// (analysis/survey/vertex_survey.hpp).
EdgeSurvey survey_edges(const IndexedMesh& mesh, BracketedValues* edge_lengths = nullptr);

}  // namespace vdwmesh
