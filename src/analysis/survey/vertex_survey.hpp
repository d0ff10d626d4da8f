// What the vertices of a triangle soup say, one by one, of its edges and of how its triangles lie.
#pragma once

#include <cstdint>

#include "analysis/distances/distribution.hpp"
#include "analysis/survey/mesh_part.hpp"
#include "core/disjoint_sets.hpp"

namespace vdwmesh {

// What the own edges and vertices of a part say. Parts can be put together: a property holds for
// the whole mesh if it holds for all parts, and counts add up.
struct PartSurvey {
  // As in MeshTopology, but `manifold` is only said of a part that is closed and oriented.
  bool closed, manifold, oriented;
  // Whether every edge has at most two half-edges and no triangle has a repeated index.
  bool at_most_two_sides;
  std::uint64_t edges, used_vertices;
};

// What to gather on the way. Both may be left out.
struct WhileSurveying {
  BracketedValues* edge_lengths = nullptr;  // gets the length of each own edge, once, Å
  // Of so many elements as the mesh has vertices: gets the ends of the own edges joined. Is only of
  // use if the result says that the part is closed, manifold and oriented.
  DisjointSets* connected = nullptr;
};

// Throws InvalidInput if a triangle names a vertex that does not exist, and LimitExceeded for more
// than 2^31 - 1 half-edges. On all cores.
PartSurvey survey_part(const MeshPart& part, const WhileSurveying& also = {});

}  // namespace vdwmesh
