// What a level does with one vertex: where its projection puts it, and which triangles the moves of
// vertices turn. The CPU refiner (refine/level.cpp) and the ranks of a parallel run
// (distributed/together/refine_together.cpp), which have parts of a mesh, share these functions, so
// that their vertices have the same bits.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/buffer.hpp"
#include "refine/crossings/constraint_formulas.hpp"
#include "refine/level_view.hpp"
#include "refine/refiner.hpp"
#include "refine/subdivision_formulas.hpp"
#include "refine/surface_view.hpp"

namespace vdwmesh {

// A vertex after its projection. `state` is `moved` if the position has changed, else `stayed`.
struct PlacedVertex {
  Vec3d position;
  VertexSpheres label;
  MoveState state;
};

// The ends of an edge, and the atoms of these vertices.
struct EdgeEnds {
  Vec3d a, b;
  SphereId atom_a, atom_b;

  // The middle, from which the projection of the edge's midpoint starts.
  Vec3d start() const { return midpoint(a, b); }
  // The label of a midpoint that stays in the middle: the atom of one end, the end whose sphere is
  // nearer to the middle by distance - radius.
  VertexSpheres unprojected_label(const Sphere* spheres) const {
    return on_sphere(nearer_sphere(spheres, atom_a, atom_b, start()));
  }
};

inline void count_outcome(const ProjectedPoint& p, ProjectionStats& stats) {
  stats.iterations_max = std::max(stats.iterations_max, p.steps);
  switch (p.outcome) {
    case ProjectionOutcome::converged:
      ++stats.projected;
      stats.residual_max = std::max(stats.residual_max, p.residual);
      break;
    case ProjectionOutcome::unconverged:
      ++stats.unconverged;
      break;
    case ProjectionOutcome::out_of_reach:
      ++stats.out_of_reach;
      break;
  }
}

inline VertexSpheres label_of(const ProjectedPoint& p) {
  return {p.spheres[0], p.spheres[1], p.spheres[2]};
}

// Projects a vertex of the given mesh, which may move it by at most `reach` (Å), and counts the
// outcome. A vertex that is on the surface already (`steps` is 0) keeps its position, and also its
// label, if it lies on all the spheres that the label names. A vertex whose projection fails keeps
// both.
inline PlacedVertex place_given(const SurfaceView& surface, const Vec3d& start,
                                const VertexSpheres& label, double reach, ProjectionStats& stats) {
  const ProjectedPoint p = surface.project(start, reach);
  count_outcome(p, stats);
  if (p.outcome != ProjectionOutcome::converged) return {start, label, MoveState::stayed};
  const bool keeps_label = p.steps == 0 && surface.on_label(p.position, label.data());
  return {p.position, keeps_label ? label : label_of(p),
          p.steps > 0 ? MoveState::moved : MoveState::stayed};
}

// Makes the midpoint of an edge of a mesh without triangle labels, and counts the outcome. If the
// projection fails, or there is none, the midpoint stays in the middle of its edge. `spheres` are
// those that labels name.
inline PlacedVertex place_midpoint(const SurfaceView& surface, const Sphere* spheres,
                                   const EdgeEnds& edge, ProjectionStats& stats) {
  const Vec3d start = edge.start();
  if (surface.projection != Projection::none) {
    const ProjectedPoint p = surface.project(start, midpoint_reach(edge.a, edge.b));
    count_outcome(p, stats);
    if (p.outcome == ProjectionOutcome::converged) {
      return {p.position, label_of(p), p.steps > 0 ? MoveState::moved : MoveState::stayed};
    }
  }
  return {start, edge.unprojected_label(spheres), MoveState::stayed};
}

// Whether moves have turned a triangle: its corners have one atom, it faces against that atom's
// outward normal, and it faced outward before the moves. A triangle of several atoms has no outward
// normal of its own: facing() measures it against the mean of the atoms' normals, which near a
// crease is no proof of a bad move. Such triangles are only counted, in ProjectionStats::turned.
inline bool is_turned(const Sphere* spheres, const std::array<Vec3d, 3>& before,
                      const std::array<Vec3d, 3>& now, const std::array<SphereId, 3>& atom) {
  return facing(spheres, now.data(), atom.data()) == Facing::against_one_atom &&
         facing(spheres, before.data(), atom.data()) == Facing::outward;
}

// The largest distance (Å) of p from the spheres of its label; infinite if that names none.
inline double sphere_residual(const Sphere* spheres, const VertexSpheres& label, const Vec3d& p) {
  if (label[0] == kNoSphere) return std::numeric_limits<double>::infinity();
  return label_residual(spheres, label.data(), p);
}

// The number of the triangles [0, triangles) that do not face outward, as facing() judges them:
// against the normal of their own sphere if triangles are labelled, and otherwise against the
// normals of the atoms of their corners. ProjectionStats::turned reports it.
std::uint64_t count_turned(const Sphere* spheres, const IndexedMesh& mesh, std::size_t triangles);

// For each vertex, the square of the length (Å) of its longest edge, as the bits of a double.
Buffer<std::uint64_t> longest_edge_squares(const IndexedMesh& mesh);

}  // namespace vdwmesh
