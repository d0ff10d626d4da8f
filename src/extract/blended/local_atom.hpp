// An atom of a blended field as one brick sees it, in float32. Host and device.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"
#include "extract/blended/edge_formulas.hpp"
#include "extract/blended/field_formulas.hpp"
#include "extract/bricks/brick_geometry.hpp"
#include "extract/bricks/edge_vertex.hpp"
#include "extract/field_kinds.hpp"

namespace vdwmesh {

struct alignas(16) LocalAtom {
  float center[3];  // Å, from the brick's node 0
  float scale;      // q = d^2 * scale
  AxisTerm term[3][kBrickReach];
  // Bit i: node plane i across the axis lies in the atom's sub-grid; all bits without sub-grids.
  std::uint16_t in_subgrid[3];
};

// Whether the atom can add anything but 0 to nodes in the box.
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

// Whether a lattice plane across an axis lies in the sub-grid of an atom; always without sub-grids.
VDWMESH_HD inline bool plane_in_subgrid(const FieldModel& m, int axis, std::int64_t lattice,
                                        const Sphere& atom) {
  if (m.truncation != Truncation::subgrid) return true;
  const std::int64_t away = lattice - 1 - subgrid_cell(m.grid, axis, atom.center[axis]);
  return away >= -m.subgrid_cells && away <= m.subgrid_cells;
}

// The atom's term at lattice plane `lattice` across an axis, whose coordinate is given, Å.
template <BlendedKind Kind>
VDWMESH_HD inline AxisTerm lattice_term(const FieldModel& m, const NodeShape& p, const Sphere& atom,
                                        float scale, int axis, std::int64_t lattice,
                                        double coordinate) {
  if (!plane_in_subgrid(m, axis, lattice, atom)) return {0, 0};
  return Kind::axis_term(p, scale, axis, static_cast<float>(coordinate - atom.center[axis]));
}

template <BlendedKind Kind>
VDWMESH_HD inline AxisTerm brick_term(const FieldModel& m, const NodeShape& p,
                                      const BrickGeometry& g, const Sphere& atom, float scale,
                                      int axis, int node) {
  const std::int32_t brick = axis == 0 ? g.brick.x : (axis == 1 ? g.brick.y : g.brick.z);
  return lattice_term<Kind>(m, p, atom, scale, axis, lattice_index(brick, node),
                            g.coordinate[axis][node]);
}

// The sum over atoms at a node of the brick, one atom further.
template <BlendedKind Kind>
VDWMESH_HD inline float add_to_node(const NodeShape& p, const LocalAtom& a, const int node[3],
                                    float sum) {
  const RowTerm row = Kind::row_term(p, a.term[1][node[1]], a.term[2][node[2]]);
  return Kind::add_atom(p, row, a.term[0][node[0]], a.scale, sum);
}

// The atom of largest contribution so far, lowest rank among equals. Atoms that add 0 do not count.
struct Strongest {
  float value = 0;
  std::uint32_t rank = 0;
  std::uint32_t atom = 0;

  VDWMESH_HD void meet(float candidate, std::uint32_t candidate_rank, std::uint32_t index) {
    if (candidate < value || !(candidate > 0)) return;
    if (candidate == value && candidate_rank > rank) return;
    value = candidate;
    rank = candidate_rank;
    atom = index;
  }
};

// Gradient of the field at a vertex, and the strongest atom there.
struct LocalGradient {
  Vec3f sum{0, 0, 0};
  Strongest strongest;
};

VDWMESH_HD inline float local_square(const Vec3f& local) {
  return std::fma(local.x, local.x, std::fma(local.y, local.y, local.z * local.z));
}

// False only where add_gradient() adds exactly 0.
template <BlendedKind Kind>
VDWMESH_HD inline bool is_in_window(const ShapeParameters<float>& shape, const Vec3f& local,
                                    float scale) {
  const float q = local_square(local) * scale;
  return Kind::reaches(shape, q);
}

// `local`: the vertex less the centre of the atom, Å.
template <BlendedKind Kind>
VDWMESH_HD inline void add_gradient(const ShapeParameters<float>& shape, const Vec3f& local,
                                    float scale, std::uint32_t rank, std::uint32_t atom,
                                    LocalGradient& g) {
  const float d2 = local_square(local);
  const ValueAndSlope<float> f = Kind::value_and_slope(shape, d2, scale);
  for (int axis = 0; axis < 3; ++axis) g.sum[axis] = std::fma(f.slope, local[axis], g.sum[axis]);
  g.strongest.meet(f.value, rank, atom);
}

// The vertex between nodes of the given values, but for its normal and label.
VDWMESH_HD inline EdgeVertex vertex_between(float inside, float outside, float isovalue,
                                            const GridSpec& grid, const CrossedEdge& edge,
                                            const Vec3d& inside_node) {
  const EdgePoint point = interpolate_edge(inside, outside, isovalue, grid.spacing);
  return {point_on_edge(edge, inside_node, point.distance), cast<float>(edge_direction(edge)),
          kNoSphere, point.clamped};
}

// Outward: down the gradient, or along the edge where it vanishes.
VDWMESH_HD inline Vec3f outward_normal(const LocalGradient& g, const EdgeVertex& v) {
  return unit_or({-g.sum.x, -g.sum.y, -g.sum.z}, cast<double>(v.normal));
}

}  // namespace vdwmesh
