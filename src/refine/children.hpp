// The part of a midpoint subdivision that does not depend on the surface: everything but the
// midpoints themselves.
#pragma once

#include "refine/level_view.hpp"

namespace vdwmesh {

// Makes `mesh`, which is that of the level: copies the parent's vertices to the front of its
// arrays, makes room for the midpoints behind them, and writes corners, labels and opposite
// half-edges of the children. Normals are there if the parent has them, labels likewise, and
// `opposite` if it is wanted and the half-edges can be numbered in 32 bits.
void make_children(const Midpoints& level, Connectivity connectivity, IndexedMesh& mesh);

}  // namespace vdwmesh
