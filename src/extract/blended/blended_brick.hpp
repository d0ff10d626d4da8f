// A blended field on one brick, on the CPU: its values and signs at the nodes, and the vertices on
// the crossed edges. Everything is computed in float32 relative to the brick's node 0, where
// coordinates are small.
// - A node's value is the sum over the brick's atoms, in list order, of a product of one term per
//   axis. The terms depend on atom and node plane alone, so neighbouring bricks compute the same
//   bits for the nodes that they share.
// - A vertex is found by linear interpolation between the values at the ends of its edge. Its
//   normal is the gradient of the field at the vertex, and its label the atom that contributes most
//   there.
// The device counterparts are count_bricks.cu and emit_vertices.cu.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "extract/blended/edge_formulas.hpp"
#include "extract/blended/local_atom.hpp"
#include "extract/bricks/brick_edges.hpp"
#include "extract/bricks/brick_geometry.hpp"
#include "extract/bricks/edge_vertex.hpp"
#include "extract/field.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// The field at all nodes that the brick's cells touch. row[z][y] holds the nodes x = 0 .. 7, a
// whole vector of float32; last[z][y] holds the node x = 8.
struct BrickValues {
  float row[kBrickReach][kBrickReach][kBrickSide];
  float last[kBrickReach][kBrickReach];
};

// A Surface as brick_extraction.hpp asks for it. One object works for one thread, brick after
// brick.
template <BlendedKind Kind>
class BlendedBrick {
 public:
  BlendedBrick(const CellListView& list, const FieldModel& model)
      : list_(list),
        model_(model),
        shape_(shape_parameters<float>(model)),
        nodes_(Kind::node_shape(model)),
        isovalue_(static_cast<float>(model.isovalue)) {}

  // Moves to a brick: gathers the atoms that reach the box of its nodes, in list order.
  void visit(const BrickIndex& brick);
  void values(BrickValues& values) const;
  void signs(BrickSigns& signs) const;
  // Calls put(i, vertex) for every edge i of `edges`, which are the brick's crossed edges.
  template <class Put>
  void vertices(const BrickEdges& edges, Put&& put) const {
    for (std::size_t i = 0; i < edges.all().size(); ++i) put(i, vertex(edges.all()[i].crossed()));
  }

 private:
  EdgeVertex vertex(const CrossedEdge& edge) const;
  LocalAtom local_atom(const Sphere& atom) const;
  std::uint16_t subgrid_planes(int axis, const Sphere& atom) const;
  void add_rows(const LocalAtom& atom, BrickValues& values) const;

  const CellListView& list_;
  const FieldModel& model_;
  ShapeParameters<float> shape_;
  NodeShape nodes_;
  float isovalue_;
  BrickGeometry geometry_{};
  std::vector<LocalAtom> atoms_;       // the atoms that reach the brick
  std::vector<std::uint32_t> places_;  // their list places
};

template <BlendedKind Kind>
LocalAtom BlendedBrick<Kind>::local_atom(const Sphere& atom) const {
  LocalAtom local;
  local.scale = static_cast<float>(inverse_square_scale(model_, atom.radius));
  for (int axis = 0; axis < 3; ++axis) {
    local.center[axis] = static_cast<float>(atom.center[axis] - geometry_.coordinate[axis][0]);
    for (int node = 0; node < kBrickReach; ++node) {
      local.term[axis][node] =
          brick_term<Kind>(model_, nodes_, geometry_, atom, local.scale, axis, node);
    }
    local.in_subgrid[axis] = subgrid_planes(axis, atom);
  }
  return local;
}

// Bit i is set if node plane i across the axis lies in the atom's sub-grid; LocalAtom::in_subgrid.
template <BlendedKind Kind>
std::uint16_t BlendedBrick<Kind>::subgrid_planes(int axis, const Sphere& atom) const {
  if (model_.truncation != Truncation::subgrid) return (1u << kBrickReach) - 1;
  const BrickIndex& b = geometry_.brick;
  const std::int32_t brick = axis == 0 ? b.x : (axis == 1 ? b.y : b.z);
  std::uint32_t planes = 0;
  for (int node = 0; node < kBrickReach; ++node) {
    if (plane_in_subgrid(model_, axis, lattice_index(brick, node), atom)) planes |= 1u << node;
  }
  return static_cast<std::uint16_t>(planes);
}

template <BlendedKind Kind>
void BlendedBrick<Kind>::visit(const BrickIndex& brick) {
  geometry_ = brick_geometry(model_.grid, brick);
  atoms_.clear();
  places_.clear();
  visit_near_box(list_, geometry_.node(0, 0, 0), geometry_.node(kBrickSide, kBrickSide, kBrickSide),
                 [&](std::uint32_t place) {
                   if (!reaches_brick(model_, geometry_, list_.spheres[place])) return false;
                   atoms_.push_back(local_atom(list_.spheres[place]));
                   places_.push_back(place);
                   return false;
                 });
}

// Adds an atom to all nodes, row by row. A row out of the atom's reach would only get zeros.
template <BlendedKind Kind>
void BlendedBrick<Kind>::add_rows(const LocalAtom& atom, BrickValues& values) const {
  AxisTerm along[kBrickReach];
  for (int x = 0; x < kBrickReach; ++x) along[x] = atom.term[0][x];
  for (int z = 0; z < kBrickReach; ++z) {
    for (int y = 0; y < kBrickReach; ++y) {
      const RowTerm term = Kind::row_term(nodes_, atom.term[1][y], atom.term[2][z]);
      if (Kind::row_is_out_of_reach(nodes_, term)) continue;
      float* row = values.row[z][y];
      for (int x = 0; x < kBrickSide; ++x) {
        row[x] = Kind::add_atom(nodes_, term, along[x], atom.scale, row[x]);
      }
      float& last = values.last[z][y];
      last = Kind::add_atom(nodes_, term, along[kBrickSide], atom.scale, last);
    }
  }
}

template <BlendedKind Kind>
void BlendedBrick<Kind>::values(BrickValues& values) const {
  values = {};
  for (const LocalAtom& atom : atoms_) add_rows(atom, values);
}

template <BlendedKind Kind>
void BlendedBrick<Kind>::signs(BrickSigns& signs) const {
  BrickValues field;
  values(field);
  for (int z = 0; z < kBrickReach; ++z) {
    for (int y = 0; y < kBrickReach; ++y) {
      std::uint32_t bits = field.last[z][y] >= isovalue_ ? 1u << kBrickSide : 0u;
      for (int x = 0; x < kBrickSide; ++x) bits |= (field.row[z][y][x] >= isovalue_ ? 1u : 0u) << x;
      signs.row[z][y] = static_cast<std::uint16_t>(bits);
    }
  }
  if (geometry_.has_virtual_nodes()) clear_virtual_nodes(geometry_, signs);
}

// Whether the node lies in the atom's sub-grid. An atom contributes to a vertex if the inside end
// of the vertex's edge lies in its sub-grid. It would be wrong to ask instead whether the atom's
// value at that node is above 0: a steep Blinn field may underflow to 0 at the node and still be
// large at the vertex.
inline bool reaches_node(const LocalAtom& a, const int node[3]) {
  return (a.in_subgrid[0] >> node[0] & a.in_subgrid[1] >> node[1] & a.in_subgrid[2] >> node[2] &
          1) != 0;
}

// The vertex on an edge. The node values are summed again instead of stored; the same operations in
// the same order give the bits from which the signs were taken.
template <BlendedKind Kind>
EdgeVertex BlendedBrick<Kind>::vertex(const CrossedEdge& edge) const {
  float inside = 0, outside = 0;
  for (const LocalAtom& atom : atoms_) {
    inside = add_to_node<Kind>(nodes_, atom, edge.inside, inside);
    outside = add_to_node<Kind>(nodes_, atom, edge.outside, outside);
  }
  EdgeVertex v = vertex_between(inside, outside, isovalue_, model_.grid, edge,
                                geometry_.node(edge.inside[0], edge.inside[1], edge.inside[2]));
  const Vec3f local = cast<float>(v.position - geometry_.node(0, 0, 0));
  LocalGradient g;
  for (std::uint32_t k = 0; k < atoms_.size(); ++k) {
    const LocalAtom& a = atoms_[k];
    if (!reaches_node(a, edge.inside)) continue;
    add_gradient<Kind>(shape_, local - Vec3f{a.center[0], a.center[1], a.center[2]}, a.scale,
                       list_.rank[places_[k]], k, g);
  }
  // If no atom contributes at the vertex, take the atom that contributes most at the inside end.
  // There is one, because the field is at least the isovalue there.
  if (!(g.strongest.value > 0)) {
    for (std::uint32_t k = 0; k < atoms_.size(); ++k) {
      const float value = add_to_node<Kind>(nodes_, atoms_[k], edge.inside, 0.0f);
      g.strongest.meet(value, list_.rank[places_[k]], k);
    }
  }
  v.normal = outward_normal(g, v);
  v.sphere = list_.id[places_[g.strongest.atom]];
  return v;
}

}  // namespace vdwmesh
