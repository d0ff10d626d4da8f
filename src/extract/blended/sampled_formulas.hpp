// Vertices and normals of a field that is given by its values at the nodes of a grid
// (SampledField). Vertices interpolate linearly along edges, normals interpolate central
// differences. Host and device.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/host_device.hpp"
#include "extract/blended/edge_formulas.hpp"
#include "extract/bricks/brick_geometry.hpp"
#include "extract/bricks/edge_vertex.hpp"
#include "extract/sampled_field.hpp"

namespace vdwmesh {

// A node by its lattice indices; 0 and cells + 2 are the virtual layer.
struct LatticeNode {
  std::int64_t index[3];
};

VDWMESH_HD inline LatticeNode lattice_node(const BrickIndex& brick, const int node[3]) {
  return {{lattice_index(brick.x, node[0]), lattice_index(brick.y, node[1]),
           lattice_index(brick.z, node[2])}};
}

VDWMESH_HD inline bool is_virtual(const GridSpec& grid, const LatticeNode& n) {
  return is_virtual(grid, 0, n.index[0]) || is_virtual(grid, 1, n.index[1]) ||
         is_virtual(grid, 2, n.index[2]);
}

// The address of a node's value in f.values. The function only computes an address: for a virtual
// node it is not the address of a value of that node, and must not be read.
VDWMESH_HD inline const float* node_address(const SampledFieldView& f, const LatticeNode& n) {
  const std::int64_t row = (n.index[2] - 1) * (f.grid.cells.y + 1) + n.index[1] - 1;
  return f.values + row * (f.grid.cells.x + 1) + n.index[0] - 1;
}

// The gradient at a node times twice the spacing, by central differences. At a node on the border
// of the grid, the component across the border is twice the one-sided difference, and 0 if the
// grid has only one node along that axis. Precondition: the node is not virtual.
VDWMESH_HD inline Vec3f node_difference(const SampledFieldView& f, const LatticeNode& n) {
  const float* const value = node_address(f, n);
  const std::int64_t width = f.grid.cells.x + 1;
  const std::int64_t stride[3] = {1, width, width * (f.grid.cells.y + 1)};
  Vec3f difference{};
  for (int axis = 0; axis < 3; ++axis) {
    const bool low = n.index[axis] > 1, high = n.index[axis] < f.grid.cells[axis] + 1;
    const float step = value[high ? stride[axis] : 0] - value[low ? -stride[axis] : 0];
    difference[axis] = low && high ? step : 2.0f * step;
  }
  return difference;
}

struct EdgeValues {
  float inside, outside;  // at the ends of a crossed edge
};

// A virtual node has no value: it gets infinity. interpolate_edge() takes the outer end of the edge
// if the outside value is not below the isovalue.
VDWMESH_HD inline EdgeValues sampled_values(const SampledFieldView& f, const BrickIndex& brick,
                                            const CrossedEdge& edge) {
  const LatticeNode inside = lattice_node(brick, edge.inside);
  const LatticeNode outside = lattice_node(brick, edge.outside);
  // The outside end differs from the inside one along the edge alone, and the inside one is real.
  const std::int64_t along = edge.axis == 0   ? outside.index[0]
                             : edge.axis == 1 ? outside.index[1]
                                              : outside.index[2];
  const bool beyond = is_virtual(f.grid, edge.axis, along);
  const float* const own = node_address(f, inside);
  const float other = *(beyond ? own : node_address(f, outside));
  return {*own, beyond ? std::numeric_limits<float>::infinity() : other};
}

// The vertex on a crossed edge, with the edge's direction as its normal. `values` are those of
// sampled_values(), and `node` is the position of the edge's inside end, Å.
VDWMESH_HD inline EdgeVertex sampled_vertex(const SampledFieldView& f, const EdgeValues& values,
                                            const CrossedEdge& edge, const Vec3d& node) {
  const EdgePoint point =
      interpolate_edge(values.inside, values.outside, f.isovalue, f.grid.spacing);
  return {point_on_edge(edge, node, point.distance), cast<float>(edge_direction(edge)), kNoSphere,
          point.clamped};
}

// The outward normal at a vertex: against the gradient, which is interpolated linearly between the
// ends of the edge. A virtual outside end has no gradient; the inside end's is taken instead.
VDWMESH_HD inline Vec3f sampled_normal(const SampledFieldView& f, const BrickIndex& brick,
                                       const CrossedEdge& edge, const EdgeVertex& v) {
  const LatticeNode inside = lattice_node(brick, edge.inside);
  const LatticeNode outside = lattice_node(brick, edge.outside);
  const Vec3f a = node_difference(f, inside);
  const Vec3f b = is_virtual(f.grid, outside) ? a : node_difference(f, outside);
  const double from = lattice_coordinate(f.grid, edge.axis, inside.index[edge.axis]);
  const double distance = edge.direction * (v.position[edge.axis] - from);
  const auto along = static_cast<float>(distance / f.grid.spacing);
  Vec3d fall{};  // against the gradient; its length does not matter
  for (int axis = 0; axis < 3; ++axis) {
    fall[axis] = -static_cast<double>(std::fma(along, b[axis] - a[axis], a[axis]));
  }
  return unit_or(fall, cast<double>(v.normal));
}

}  // namespace vdwmesh
