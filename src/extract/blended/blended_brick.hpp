// A blended field on one brick, on the CPU: its values and signs at the nodes, and the vertices on
// the crossed edges. Everything is computed in float32, from differences of coordinates: these are
// taken in double, and are small.
// - A node's value is the sum over the brick's atoms, in the order of the cell list, of a product
//   of one term per axis. A term comes from the difference of the node's plane and the atom's
//   centre, so it is the same in every brick. Neighbouring bricks gather different atoms, but an
//   atom that only one of them gathers adds exactly 0 to each node that they share (field_reach()).
//   So both bricks compute the same bits for these nodes.
// - A vertex is found by linear interpolation between the values at the ends of its edge. Its
//   normal points against the gradient of the field at the vertex, and its label is the atom that
//   contributes most there. Both are computed with atoms relative to the brick's node 0, only in
//   the brick that owns the edge.
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

// The field at all 9 x 9 x 9 nodes that the brick's cells touch. row[z][y] holds the nodes x = 0 ..
// 7, last[z][y] the node x = 8: without it, a row fills one SIMD register of eight float32.
struct BrickValues {
  float row[kBrickReach][kBrickReach][kBrickSide];
  float last[kBrickReach][kBrickReach];
};

// What the loops of brick_extraction.hpp take as their template argument Surface, for blended
// fields. One object works for one thread: visit() moves it to a brick, and the other functions
// compute the values, signs or vertices of that brick.
template <BlendedKind Kind>
class BlendedBrick {
 public:
  BlendedBrick(const CellListView& list, const FieldModel& model)
      : list_(list),
        model_(model),
        shape_(shape_parameters<float>(model)),
        node_shape_(Kind::node_shape(model)),
        isovalue_(static_cast<float>(model.isovalue)) {}

  // Moves to a brick: gathers the atoms that reach the box of its nodes, in the order
  // of the cell list.
  void visit(const BrickIndex& brick);
  // Computes the field at all 9 x 9 x 9 nodes, virtual ones included.
  void values(BrickValues& values) const;
  // Sets the bits of the nodes at which the field is at least the isovalue; virtual nodes have 0.
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
  // The field's parameters twice, in the forms in which the formulas for gradients at vertices and
  // the formulas for sums at nodes take them.
  ShapeParameters<float> shape_;
  NodeShape node_shape_;
  float isovalue_;
  BrickGeometry geometry_{};
  std::vector<LocalAtom> atoms_;  // the atoms that reach the brick
  // By index in atoms_. With it list_ gives the id and the rank of the atom. Of atoms that
  // contribute equally, the one of lowest rank gives the label.
  std::vector<ListPlace> places_;
};

template <BlendedKind Kind>
LocalAtom BlendedBrick<Kind>::local_atom(const Sphere& atom) const {
  LocalAtom local;
  local.scale = static_cast<float>(inverse_square_scale(model_, atom.radius));
  for (int axis = 0; axis < 3; ++axis) {
    local.center[axis] = static_cast<float>(atom.center[axis] - geometry_.coordinate[axis][0]);
    for (int node = 0; node < kBrickReach; ++node) {
      // The term is 0 at planes outside the atom's sub-grid, so sums over nodes need not
      // ask in_subgrid.
      local.term[axis][node] =
          brick_term<Kind>(model_, node_shape_, geometry_, atom, local.scale, axis, node);
    }
    local.in_subgrid[axis] = subgrid_planes(axis, atom);
  }
  return local;
}

// LocalAtom::in_subgrid along one axis: bit i is set if the plane of the brick's nodes i lies in
// the atom's sub-grid, the box of grid cells at which a thesis preset cuts off the atom's field.
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

// The cell list gives a superset of the atoms needed, and reaches_brick() drops those too far away.
// The visitor always returns false, because true would end the visit early.
template <BlendedKind Kind>
void BlendedBrick<Kind>::visit(const BrickIndex& brick) {
  geometry_ = brick_geometry(model_.grid, brick);
  atoms_.clear();
  places_.clear();
  visit_near_box(list_, geometry_.node(0, 0, 0), geometry_.node(kBrickSide, kBrickSide, kBrickSide),
                 [&](ListPlace place) {
                   if (!reaches_brick(model_, geometry_, list_.spheres[place])) return false;
                   atoms_.push_back(local_atom(list_.spheres[place]));
                   places_.push_back(place);
                   return false;
                 });
}

// Adds an atom to all nodes, row by row. A row out of the atom's reach is skipped, because the atom
// would add exactly 0 to each of its nodes. The terms along x are copied into a local array: the
// compiler then knows that the stores into `values` do not change them, and vectorises the loop.
template <BlendedKind Kind>
void BlendedBrick<Kind>::add_rows(const LocalAtom& atom, BrickValues& values) const {
  AxisTerm along[kBrickReach];
  for (int x = 0; x < kBrickReach; ++x) along[x] = atom.term[0][x];
  for (int z = 0; z < kBrickReach; ++z) {
    for (int y = 0; y < kBrickReach; ++y) {
      const RowTerm term = Kind::row_term(node_shape_, atom.term[1][y], atom.term[2][z]);
      if (Kind::row_is_out_of_reach(node_shape_, term)) continue;
      float* row = values.row[z][y];
      for (int x = 0; x < kBrickSide; ++x) {
        row[x] = Kind::add_atom(node_shape_, term, along[x], atom.scale, row[x]);
      }
      float& last = values.last[z][y];
      last = Kind::add_atom(node_shape_, term, along[kBrickSide], atom.scale, last);
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

// Whether the atom's sub-grid contains the node; always true for fields without sub-grids. In a
// field with sub-grids, an atom contributes to a vertex if the inside end of the vertex's edge lies
// in its sub-grid. To ask instead whether the atom's value at that node is above 0 would be a wrong
// test: the terms of a steep Blinn field may underflow to 0 at the node while the contribution at
// the vertex is large.
inline bool subgrid_contains(const LocalAtom& a, const int node[3]) {
  return (a.in_subgrid[0] >> node[0] & a.in_subgrid[1] >> node[1] & a.in_subgrid[2] >> node[2] &
          1) != 0;
}

// The vertex on an edge. The values at its two ends are summed again instead of stored. The
// operations and their order are those of values(), so the bits are those from which the signs were
// taken. A virtual node is outside even if its value is at least the isovalue; vertex_between()
// then puts the vertex on the virtual node, the outside end of the edge. If the gradient vanishes,
// outward_normal() returns the direction of the edge.
template <BlendedKind Kind>
EdgeVertex BlendedBrick<Kind>::vertex(const CrossedEdge& edge) const {
  float inside = 0, outside = 0;
  for (const LocalAtom& atom : atoms_) {
    inside = add_to_node<Kind>(node_shape_, atom, edge.inside, inside);
    outside = add_to_node<Kind>(node_shape_, atom, edge.outside, outside);
  }
  EdgeVertex v = vertex_between(inside, outside, isovalue_, model_.grid, edge,
                                geometry_.node(edge.inside[0], edge.inside[1], edge.inside[2]));
  const Vec3f local = cast<float>(v.position - geometry_.node(0, 0, 0));
  LocalGradient g;
  for (std::uint32_t k = 0; k < atoms_.size(); ++k) {
    const LocalAtom& a = atoms_[k];
    if (!subgrid_contains(a, edge.inside)) continue;
    add_gradient<Kind>(shape_, local - Vec3f{a.center[0], a.center[1], a.center[2]}, a.scale,
                       list_.rank[places_[k]], k, g);
  }
  // If no atom contributes at the vertex, the label is the atom that contributes most at the inside
  // end. There is such an atom, because the field there is at least the isovalue, which is above 0.
  // meet() keeps the larger of two contributions, and of equal ones that of lower rank.
  if (!(g.strongest.value > 0)) {
    for (std::uint32_t k = 0; k < atoms_.size(); ++k) {
      const float value = add_to_node<Kind>(node_shape_, atoms_[k], edge.inside, 0.0f);
      g.strongest.meet(value, list_.rank[places_[k]], k);
    }
  }
  v.normal = outward_normal(g, v);
  v.sphere = list_.id[places_[g.strongest.atom]];
  return v;
}

}  // namespace vdwmesh
