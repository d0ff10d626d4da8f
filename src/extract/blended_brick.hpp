// A blended field seen from one brick, in float32 relative to it. CPU.
#pragma once

#include <cstdint>
#include <vector>

#include "extract/brick_geometry.hpp"
#include "extract/cell_list.hpp"
#include "extract/edge_formulas.hpp"
#include "extract/field.hpp"
#include "extract/local_atom.hpp"
#include "extract/surface_vertex.hpp"

namespace vdwmesh {

template <FieldKind kind>
class BlendedBrick {
 public:
  BlendedBrick(const CellListView& list, const FieldModel& model)
      : list_(list),
        model_(model),
        shape_(shape_parameters<float>(model)),
        spacing_(static_cast<float>(model.grid.spacing)),
        isovalue_(static_cast<float>(model.isovalue)) {}

  // Gathers the atoms that reach the brick's nodes, in list order.
  void visit(const BrickIndex& brick);
  void signs(BrickSigns& signs) const;
  SurfaceVertex vertex(const CrossedEdge& edge) const;

 private:
  void add_rows(const LocalAtom& atom, float (&rows)[kBrickReach][kBrickReach][kBrickSide],
                float (&last)[kBrickReach][kBrickReach]) const;

  const CellListView& list_;
  const FieldModel& model_;
  ShapeParameters<float> shape_;
  float spacing_, isovalue_;
  BrickGeometry geometry_{};
  std::vector<LocalAtom> atoms_;
  std::vector<std::uint32_t> places_;
};

template <FieldKind kind>
void BlendedBrick<kind>::visit(const BrickIndex& brick) {
  geometry_ = brick_geometry(model_.grid, brick);
  atoms_.clear();
  places_.clear();
  visit_near_box(list_, geometry_.node(0, 0, 0), geometry_.node(kBrickSide, kBrickSide, kBrickSide),
                 [&](std::uint32_t place) {
                   atoms_.push_back(local_atom(model_, geometry_, list_.spheres[place]));
                   places_.push_back(place);
                   return false;
                 });
}

// Adds the atom to the nodes x = 0 .. 7 of every row, and to the nodes x = 8.
template <FieldKind kind>
void BlendedBrick<kind>::add_rows(const LocalAtom& atom,
                                  float (&rows)[kBrickReach][kBrickReach][kBrickSide],
                                  float (&last)[kBrickReach][kBrickReach]) const {
  float dx[kBrickReach], dy[kBrickReach], dz[kBrickReach];
  float mask_x[kBrickReach];
  for (int i = 0; i < kBrickReach; ++i) {
    dx[i] = node_offset(atom, 0, i, spacing_);
    dy[i] = node_offset(atom, 1, i, spacing_);
    dz[i] = node_offset(atom, 2, i, spacing_);
    mask_x[i] = atom.reaches(0, i) ? 1.0f : 0.0f;
  }
  for (int z = 0; z < kBrickReach; ++z) {
    if (!atom.reaches(2, z)) continue;
    for (int y = 0; y < kBrickReach; ++y) {
      if (!atom.reaches(1, y)) continue;
      const float dyz2 = std::fma(dy[y], dy[y], dz[z] * dz[z]);
      if (dyz2 > atom.reach_square) continue;
      float* row = rows[z][y];
      for (int x = 0; x < kBrickSide; ++x) {
        row[x] += mask_x[x] * shape_value<kind>(shape_, std::fma(dx[x], dx[x], dyz2), atom.scale);
      }
      constexpr int end = kBrickSide;
      last[z][y] +=
          mask_x[end] * shape_value<kind>(shape_, std::fma(dx[end], dx[end], dyz2), atom.scale);
    }
  }
}

template <FieldKind kind>
void BlendedBrick<kind>::signs(BrickSigns& signs) const {
  float rows[kBrickReach][kBrickReach][kBrickSide] = {};
  float last[kBrickReach][kBrickReach] = {};
  for (const LocalAtom& atom : atoms_) add_rows(atom, rows, last);
  for (int z = 0; z < kBrickReach; ++z) {
    for (int y = 0; y < kBrickReach; ++y) {
      std::uint32_t bits = last[z][y] >= isovalue_ ? 1u << kBrickSide : 0u;
      for (int x = 0; x < kBrickSide; ++x) bits |= (rows[z][y][x] >= isovalue_ ? 1u : 0u) << x;
      signs.row[z][y] = static_cast<std::uint16_t>(bits);
    }
  }
  if (geometry_.has_virtual_nodes()) clear_virtual_nodes(geometry_, signs);
}

template <FieldKind kind>
SurfaceVertex BlendedBrick<kind>::vertex(const CrossedEdge& edge) const {
  EdgeValues values;
  for (std::uint32_t k = 0; k < atoms_.size(); ++k) {
    add_to_edge<kind>(shape_, atoms_[k], edge, spacing_, list_.rank[places_[k]], k, values);
  }
  const EdgePoint point =
      interpolate_edge(values.inside, values.outside, isovalue_, model_.grid.spacing);
  const Vec3d node = geometry_.node(edge.inside[0], edge.inside[1], edge.inside[2]);
  Vec3d p = node, outward{0, 0, 0};
  p[edge.axis] = std::fma(edge.direction, point.distance, node[edge.axis]);
  outward[edge.axis] = edge.direction;
  const Vec3f local = cast<float>(p - geometry_.node(0, 0, 0));
  LocalGradient g;
  g.strongest.atom = values.strongest.atom;
  for (std::uint32_t k = 0; k < atoms_.size(); ++k) {
    add_gradient<kind>(shape_, atoms_[k], edge.inside, local, list_.rank[places_[k]], k, g);
  }
  const Vec3d fall{-g.sum.x, -g.sum.y, -g.sum.z};
  return {p, unit_or(fall, outward), list_.id[places_[g.strongest.atom]], point.clamped};
}

}  // namespace vdwmesh
