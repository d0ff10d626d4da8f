// Midpoints of a mesh whose triangles are labelled with the smooth piece of the surface on which
// they lie, and whose edges follow the curves in which pieces meet. If both triangles at an edge
// have the same piece, the midpoint is put on that piece, otherwise on the curve in which their two
// pieces meet. No midpoint can move to a wrong piece, so no search for bad moves is made. A
// triangle may be turned nevertheless if the mesh is too coarse there; it is only counted.
//
// A Constraint knows the pieces: spheres alone (level.cpp) or patches of all kinds
// (patch_refiner.cpp). It has these members:
//   Pieces                     the pieces at an edge
//   projects()                 false: midpoints stay in the middle of their edges
//   pieces(parent, t, other)   the pieces at the edge between two triangles of the parent
//   midpoint(pieces, u, v)     where the midpoint of an edge from u to v goes
//   residual(pieces, p)        the largest distance (Å) of p from the pieces
//   label(pieces, p)           the label of a midpoint at p
//   normal(pieces, level, h, p)   its normal there, for the parent's half-edge h
#pragma once

#include "refine/crossings/tally.hpp"
#include "refine/level_view.hpp"

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

// Makes all midpoints of the level's mesh. Precondition: make_children() has resized its arrays.
template <class Constraint>
ProjectionStats constrain_midpoints(const Constraint& constraint, const Midpoints& level,
                                    IndexedMesh& mesh, Monitor* monitor) {
  return tally(level.items(), monitor, [&](std::size_t h, ProjectionStats& total) {
    if (!level.handled_by_item(h)) return;  // the lower half-edge of the edge makes the midpoint
    make_midpoint_of(constraint, level, h, mesh, total);
  });
}

}  // namespace vdwmesh
