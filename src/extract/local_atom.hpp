// An atom of a blended field as one brick sees it, in float32. Host and device.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"
#include "extract/brick_geometry.hpp"
#include "extract/field_formulas.hpp"
#include "extract/node_terms.hpp"
#include "extract/surface_vertex.hpp"

namespace vdwmesh {

struct alignas(16) LocalAtom {
  float center[3];  // Å, from the brick's node 0
  float scale;      // q = d^2 * scale
  AxisTerm term[3][kBrickReach];
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

// The atom's term at lattice plane `lattice` across an axis, whose coordinate is given, Å.
template <FieldKind kind>
VDWMESH_HD inline AxisTerm lattice_term(const FieldModel& m, const NodeShape& p, const Sphere& atom,
                                        float scale, int axis, std::int64_t lattice,
                                        double coordinate) {
  if (m.truncation == Truncation::subgrid) {
    const std::int64_t away = lattice - 1 - subgrid_cell(m.grid, axis, atom.center[axis]);
    if (away < -m.subgrid_cells || away > m.subgrid_cells) return {0, 0};
  }
  return axis_term<kind>(p, scale, axis, static_cast<float>(coordinate - atom.center[axis]));
}

template <FieldKind kind>
VDWMESH_HD inline AxisTerm brick_term(const FieldModel& m, const NodeShape& p,
                                      const BrickGeometry& g, const Sphere& atom, float scale,
                                      int axis, int node) {
  const std::int32_t brick = axis == 0 ? g.brick.x : (axis == 1 ? g.brick.y : g.brick.z);
  return lattice_term<kind>(m, p, atom, scale, axis, lattice_index(brick, node),
                            g.coordinate[axis][node]);
}

// What an atom alone adds to a node of the brick.
template <FieldKind kind>
VDWMESH_HD inline float node_value(const NodeShape& p, const LocalAtom& a, const int node[3]) {
  const RowTerm row = row_term<kind>(p, a.term[1][node[1]], a.term[2][node[2]]);
  return add_atom<kind>(p, row, a.term[0][node[0]], a.scale, 0.0f);
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

// The field at the ends of an edge, and the strongest atom at its inside end.
struct EdgeValues {
  float inside = 0, outside = 0;
  Strongest strongest;
};

template <FieldKind kind>
VDWMESH_HD inline void add_to_edge(const NodeShape& p, const LocalAtom& a, const CrossedEdge& edge,
                                   std::uint32_t rank, std::uint32_t atom, EdgeValues& values) {
  const auto row = [&](const int node[3]) {
    return row_term<kind>(p, a.term[1][node[1]], a.term[2][node[2]]);
  };
  const RowTerm inside = row(edge.inside), outside = row(edge.outside);
  const AxisTerm &x_inside = a.term[0][edge.inside[0]], &x_outside = a.term[0][edge.outside[0]];
  values.strongest.meet(add_atom<kind>(p, inside, x_inside, a.scale, 0.0f), rank, atom);
  values.inside = add_atom<kind>(p, inside, x_inside, a.scale, values.inside);
  values.outside = add_atom<kind>(p, outside, x_outside, a.scale, values.outside);
}

// Gradient of the field at a vertex, and the strongest atom there; begin with that of the inside
// end, for a vertex that no atom reaches. Sub-grids count as at the inside end.
struct LocalGradient {
  Vec3f sum{0, 0, 0};
  Strongest strongest;
};

template <FieldKind kind>
VDWMESH_HD inline void add_gradient(const ShapeParameters<float>& shape, const LocalAtom& a,
                                    const int inside[3], const Vec3f& local, std::uint32_t rank,
                                    std::uint32_t atom, LocalGradient& g) {
  Vec3f d{};
  float reached = 1;
  for (int axis = 0; axis < 3; ++axis) {
    reached *= a.term[axis][inside[axis]].factor;
    d[axis] = local[axis] - a.center[axis];
  }
  if (reached == 0) return;
  const float d2 = std::fma(d.x, d.x, std::fma(d.y, d.y, d.z * d.z));
  const ValueAndSlope<float> f = shape_value_and_slope<kind>(shape, d2, a.scale);
  for (int axis = 0; axis < 3; ++axis) g.sum[axis] = std::fma(f.slope, d[axis], g.sum[axis]);
  g.strongest.meet(f.value, rank, atom);
}

}  // namespace vdwmesh
