// An atom of a blended field in float32 coordinates relative to a brick. Host and device.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"
#include "extract/brick_geometry.hpp"
#include "extract/field_formulas.hpp"
#include "extract/surface_vertex.hpp"

namespace vdwmesh {

// The first node of the next brick (local index 8) is measured from the next brick's own first
// node, as that brick measures it: both bricks then compute the same value for it, bit for bit.
struct LocalAtom {
  float center[3];              // Å, from the brick's node 0
  float next_center[3];         // Å, from its node 8
  float scale;                  // q = d^2 * scale
  float reach_square;           // Å²; contributes exactly 0 beyond
  std::int8_t low[3], high[3];  // local nodes of its sub-grid; all of them without one

  VDWMESH_HD bool reaches(int axis, int node) const {
    return low[axis] <= node && node <= high[axis];
  }
};

VDWMESH_HD inline std::int8_t clamp_local(std::int64_t node) {
  return static_cast<std::int8_t>(node < -1 ? -1 : (node > kBrickReach ? kBrickReach : node));
}

VDWMESH_HD inline LocalAtom local_atom(const FieldModel& m, const BrickGeometry& g,
                                       const Sphere& atom) {
  LocalAtom local{};
  const std::int32_t brick[3] = {g.brick.x, g.brick.y, g.brick.z};
  for (int axis = 0; axis < 3; ++axis) {
    local.center[axis] = static_cast<float>(atom.center[axis] - g.coordinate[axis][0]);
    local.next_center[axis] =
        static_cast<float>(atom.center[axis] - g.coordinate[axis][kBrickSide]);
    local.low[axis] = 0;
    local.high[axis] = kBrickSide;
    if (m.truncation == Truncation::subgrid) {
      const std::int64_t first = lattice_index(brick[axis], 0) - 1;  // node 0 in node units
      const std::int64_t cell = subgrid_cell(m.grid, axis, atom.center[axis]);
      local.low[axis] = clamp_local(cell - m.subgrid_cells - first);
      local.high[axis] = clamp_local(cell + m.subgrid_cells - first);
    }
  }
  const double scale = inverse_square_scale(m, atom.radius);
  local.scale = static_cast<float>(scale);
  const double reach = field_reach_square(m, scale);
  local.reach_square = static_cast<float>(reach * (1 + 1e-5));
  return local;
}

VDWMESH_HD inline float node_offset(const LocalAtom& a, int axis, int node, float spacing) {
  return node == kBrickSide ? -a.next_center[axis]
                            : static_cast<float>(node) * spacing - a.center[axis];
}

template <FieldKind kind>
VDWMESH_HD inline float node_value(const ShapeParameters<float>& shape, const LocalAtom& a,
                                   const int node[3], float spacing) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!a.reaches(axis, node[axis])) return 0;
  }
  const float dx = node_offset(a, 0, node[0], spacing), dy = node_offset(a, 1, node[1], spacing),
              dz = node_offset(a, 2, node[2], spacing);
  return shape_value<kind>(shape, std::fma(dx, dx, std::fma(dy, dy, dz * dz)), a.scale);
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
VDWMESH_HD inline void add_to_edge(const ShapeParameters<float>& shape, const LocalAtom& a,
                                   const CrossedEdge& edge, float spacing, std::uint32_t rank,
                                   std::uint32_t atom, EdgeValues& values) {
  const float inside = node_value<kind>(shape, a, edge.inside, spacing);
  values.inside += inside;
  values.outside += node_value<kind>(shape, a, edge.outside, spacing);
  values.strongest.meet(inside, rank, atom);
}

// Gradient of the field at a vertex, and the strongest atom there; begin with that of the inside
// end, for a vertex that no atom reaches. Sub-grids count as at the inside end.
struct LocalGradient {
  Vec3d sum{0, 0, 0};
  Strongest strongest;
};

template <FieldKind kind>
VDWMESH_HD inline void add_gradient(const ShapeParameters<float>& shape, const LocalAtom& a,
                                    const int inside[3], const Vec3f& local, std::uint32_t rank,
                                    std::uint32_t atom, LocalGradient& g) {
  Vec3f d{};
  for (int axis = 0; axis < 3; ++axis) {
    if (!a.reaches(axis, inside[axis])) return;
    d[axis] = local[axis] - a.center[axis];
  }
  const float d2 = std::fma(d.x, d.x, std::fma(d.y, d.y, d.z * d.z));
  const ValueAndSlope<float> f = shape_value_and_slope<kind>(shape, d2, a.scale);
  const double slope = f.slope;
  for (int axis = 0; axis < 3; ++axis) {
    g.sum[axis] = std::fma(slope, static_cast<double>(d[axis]), g.sum[axis]);
  }
  g.strongest.meet(f.value, rank, atom);
}

}  // namespace vdwmesh
