// An atom of a blended field in the coordinates of one brick, in float32, and the formulas for its
// contribution to nodes and vertices. The CPU and the device share them, which makes their sums
// agree bit by bit. Host and device.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"
#include "extract/blended/edge_formulas.hpp"
#include "extract/blended/field_formulas.hpp"
#include "extract/bricks/brick_geometry.hpp"
#include "extract/bricks/edge_vertex.hpp"
#include "extract/field_kinds.hpp"
#include "spheres/list_place.hpp"

namespace vdwmesh {

// Gradients at vertices use `center`. Values at nodes use `term` instead, which does not depend on
// the brick, so that neighbouring bricks agree on the nodes that they share.
struct alignas(16) LocalAtom {
  float center[3];                // Å, from the brick's node 0
  float scale;                    // q = d^2 * scale
  AxisTerm term[3][kBrickReach];  // [axis][node plane]
  // Bit i: node plane i across the axis lies in the atom's sub-grid. All set without sub-grids.
  std::uint16_t in_subgrid[3];
};

// False only if the atom adds exactly 0 to all nodes in the box. For fields with sub-grids it is
// always true: such an atom is used wherever the cell list gives it, and its terms are 0 at planes
// outside its sub-grid.
VDWMESH_HD inline bool reaches_box(const FieldModel& m, const Vec3d& lower, const Vec3d& upper,
                                   const Sphere& atom) {
  if (m.truncation == Truncation::subgrid) return true;
  double d2 = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double below = lower[axis] - atom.center[axis], above = atom.center[axis] - upper[axis];
    const double d = below > 0 ? below : (above > 0 ? above : 0);
    d2 += d * d;
  }
  const double reach = field_reach(m, atom.radius);
  return d2 <= reach * reach;
}

VDWMESH_HD inline bool reaches_brick(const FieldModel& m, const BrickGeometry& g,
                                     const Sphere& atom) {
  return reaches_box(m, g.node(0, 0, 0), g.node(kBrickSide, kBrickSide, kBrickSide), atom);
}

// Whether a plane of nodes across an axis, given by its lattice index, lies in the sub-grid of an
// atom; true without sub-grids.
VDWMESH_HD inline bool plane_in_subgrid(const FieldModel& m, int axis, std::int64_t lattice,
                                        const Sphere& atom) {
  if (m.truncation != Truncation::subgrid) return true;
  const std::int64_t away = lattice - 1 - subgrid_cell(m.grid, axis, atom.center[axis]);
  return away >= -m.subgrid_cells && away <= m.subgrid_cells;
}

// The atom's term at a plane of nodes across an axis. `lattice` is the plane's lattice index and
// `coordinate` its position, Å. The difference between plane and atom is taken in double from
// absolute coordinates and then rounded, so the term is the same in every brick with this plane.
template <BlendedKind Kind>
VDWMESH_HD inline AxisTerm lattice_term(const FieldModel& m, const NodeShape& p, const Sphere& atom,
                                        float scale, int axis, std::int64_t lattice,
                                        double coordinate) {
  if (!plane_in_subgrid(m, axis, lattice, atom)) return {0, 0};
  return Kind::axis_term(p, scale, axis, static_cast<float>(coordinate - atom.center[axis]));
}

// lattice_term() for node plane `node` = 0 .. 8 of a brick.
template <BlendedKind Kind>
VDWMESH_HD inline AxisTerm brick_term(const FieldModel& m, const NodeShape& p,
                                      const BrickGeometry& g, const Sphere& atom, float scale,
                                      int axis, int node) {
  const std::int32_t brick = axis == 0 ? g.brick.x : (axis == 1 ? g.brick.y : g.brick.z);
  return lattice_term<Kind>(m, p, atom, scale, axis, lattice_index(brick, node),
                            g.coordinate[axis][node]);
}

// Returns `sum` plus the atom's contribution at a node of the brick.
template <BlendedKind Kind>
VDWMESH_HD inline float add_to_node(const NodeShape& p, const LocalAtom& a, const int node[3],
                                    float sum) {
  const RowTerm row = Kind::row_term(p, a.term[1][node[1]], a.term[2][node[2]]);
  return Kind::add_atom(p, row, a.term[0][node[0]], a.scale, sum);
}

// A running maximum: the atom of largest contribution so far. Among equal contributions the lowest
// rank wins. Contributions of 0 do not count, so a value of 0 means that no atom has contributed.
struct Strongest {
  float value = 0;
  Rank rank{};
  std::uint32_t atom = 0;

  // Takes the candidate if it is larger than the maximum so far, or equal and of lower rank. While
  // the maximum is 0, its rank is 0, and none is lower: a candidate of 0 is never taken.
  VDWMESH_HD void meet(float candidate, Rank candidate_rank, std::uint32_t index) {
    if (!(candidate > value || (candidate == value && candidate_rank < rank))) return;
    value = candidate;
    rank = candidate_rank;
    atom = index;
  }
};

// Sums at a vertex, over the atoms given to add_gradient().
struct LocalGradient {
  Vec3f sum{0, 0, 0};  // half the gradient of the field at a vertex, 1/Å
  Strongest strongest;
};

VDWMESH_HD inline float local_square(const Vec3f& local) {
  return std::fma(local.x, local.x, std::fma(local.y, local.y, local.z * local.z));
}

// Adds an atom to the gradient at a vertex. `local` is the vertex less the atom's centre, Å.
template <BlendedKind Kind>
VDWMESH_HD inline void add_gradient(const ShapeParameters<float>& shape, const Vec3f& local,
                                    float scale, Rank rank, std::uint32_t atom, LocalGradient& g) {
  const float d2 = local_square(local);
  const ValueAndSlope<float> f = Kind::value_and_slope(shape, d2, scale);
  for (int axis = 0; axis < 3; ++axis) g.sum[axis] = std::fma(f.slope, local[axis], g.sum[axis]);
  g.strongest.meet(f.value, rank, atom);
}

// The vertex on an edge whose ends have these values. It has no label yet, and its normal is the
// edge's direction, the fallback of outward_normal().
VDWMESH_HD inline EdgeVertex vertex_between(float inside, float outside, float isovalue,
                                            const GridSpec& grid, const CrossedEdge& edge,
                                            const Vec3d& inside_node) {
  const EdgePoint point = interpolate_edge(inside, outside, isovalue, grid.spacing);
  return {point_on_edge(edge, inside_node, point.distance), cast<float>(edge_direction(edge)),
          kNoSphere, point.clamped};
}

// The outward normal: against the gradient, or v.normal if the gradient vanishes.
VDWMESH_HD inline Vec3f outward_normal(const LocalGradient& g, const EdgeVertex& v) {
  return unit_or({-g.sum.x, -g.sum.y, -g.sum.z}, cast<double>(v.normal));
}

}  // namespace vdwmesh
