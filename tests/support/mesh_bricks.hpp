// Marching cubes over a list of bricks, as a test wants it.
#pragma once

#include "core/workspace.hpp"
#include "extract/bricks/brick_mesher.hpp"

namespace vdwmesh::testing {

// Into a new result and without a workspace.
inline ExtractResult mesh_bricks(const GridSpec& grid, const CandidateSearch& candidates,
                                 const BrickLoops& loops, LabelWidth width,
                                 const ExtractOptions& options) {
  ExtractResult result;
  Workspace workspace;
  vdwmesh::mesh_bricks(result, grid, candidates, loops, width, options, workspace);
  return result;
}

}  // namespace vdwmesh::testing
