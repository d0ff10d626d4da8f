// Midpoints of a mesh whose triangles say on which smooth piece of the surface they lie, and whose
// edges follow the curves in which pieces meet. A midpoint is put on the pieces of the two
// triangles at its edge: on their piece if it is one, else on their curve. No midpoint can be drawn
// to a wrong piece, so bad moves are not looked for. A triangle that is turned nevertheless,
// because the mesh is too coarse there, is only counted.
//
// Which pieces there are, spheres alone (level.cpp) or patches of all kinds (patch_refiner.cpp), is
// said by a Constraint with these members:
//   Pieces                     the pieces at an edge
//   projects()                 false: midpoints stay in the middle of their edges
//   pieces(parent, t, other)   those of two triangles of the parent, which may be the same
//   midpoint(pieces, u, v)     where the midpoint of an edge from u to v goes
//   residual(pieces, p)        the largest distance (Å) of p from the pieces
//   label(pieces, p)           the label of a midpoint at p
//   normal(pieces, level, h, p)   its normal there, for the parent's half-edge h
#pragma once

#include "refine/level_view.hpp"
#include "refine/tally.hpp"

namespace vdwmesh {

template <class Constraint>
void make_midpoint_of(const Constraint& constraint, const Midpoints& level, std::size_t h,
                      IndexedMesh& mesh, ProjectionStats& stats) {
  const IndexedMesh& parent = level.parent;
  const auto pieces = constraint.pieces(parent, h / 3, parent.opposite[h] / 3);
  const Vec3d p = constraint.projects()
                      ? constraint.midpoint(pieces, parent.positions[level.start_of(h)],
                                            parent.positions[level.end_of(h)])
                      : level.middle_of(h);
  const std::uint32_t v = level.midpoint_of(h);
  mesh.positions[v] = p;
  mesh.vertex_spheres.set(v, constraint.label(pieces, p));
  if (!mesh.normals.empty()) mesh.normals[v] = constraint.normal(pieces, level, h, p);
  if (constraint.projects()) count_residual(constraint.residual(pieces, p), stats);
}

// Makes all midpoints of the level's mesh, which make_children() has made room for.
template <class Constraint>
ProjectionStats constrain_midpoints(const Constraint& constraint, const Midpoints& level,
                                    IndexedMesh& mesh, Monitor* monitor) {
  return tally(level.items(), monitor, [&](std::size_t h, ProjectionStats& total) {
    if (!level.handled_by_item(h)) return;  // the lower half-edge of the edge makes the midpoint
    make_midpoint_of(constraint, level, h, mesh, total);
  });
}

}  // namespace vdwmesh
