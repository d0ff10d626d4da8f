// The union of balls seen from one brick: node signs and the vertex on an edge. CPU.
#pragma once

#include <cstdint>
#include <vector>

#include "extract/brick_geometry.hpp"
#include "extract/cell_list.hpp"
#include "extract/edge_formulas.hpp"
#include "extract/field.hpp"
#include "extract/surface_vertex.hpp"

namespace vdwmesh {

class UnionBrick {
 public:
  UnionBrick(const CellListView& list, const FieldModel& model) : list_(list), grid_(model.grid) {}

  // Gathers the balls that touch the brick's nodes.
  void visit(const BrickIndex& brick);
  void signs(BrickSigns& signs) const;
  SurfaceVertex vertex(const CrossedEdge& edge) const;

 private:
  struct Candidate {
    Sphere ball;
    std::uint32_t rank;
    SphereId id;
  };
  const CellListView& list_;
  const GridSpec& grid_;
  BrickGeometry geometry_{};
  std::vector<Candidate> candidates_;
};

inline void UnionBrick::visit(const BrickIndex& brick) {
  geometry_ = brick_geometry(grid_, brick);
  candidates_.clear();
  const Vec3d lower = geometry_.node(0, 0, 0);
  const Vec3d upper = geometry_.node(kBrickSide, kBrickSide, kBrickSide);
  visit_near_box(list_, lower, upper, [&](std::uint32_t place) {
    const Sphere& ball = list_.spheres[place];
    double d2 = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double below = lower[axis] - ball.center[axis], above = ball.center[axis] - upper[axis];
      const double d = below > 0 ? below : (above > 0 ? above : 0);
      d2 += d * d;
    }
    // The factor covers the rounding of d2 against the predicate's.
    if (d2 <= ball.radius * ball.radius * (1 + 1e-12)) {
      candidates_.push_back({ball, list_.rank[place], list_.id[place]});
    }
    return false;
  });
}

inline void UnionBrick::signs(BrickSigns& signs) const {
  constexpr int lanes = 12;  // 9 nodes, filled up to whole vectors of 4
  std::int64_t inside[kBrickReach][kBrickReach][lanes] = {};
  for (const Candidate& c : candidates_) {
    const double r2 = c.ball.radius * c.ball.radius;
    double dx[lanes], dy[kBrickReach], dz2[kBrickReach];
    for (int x = 0; x < lanes; ++x) {
      dx[x] = geometry_.coordinate[0][x < kBrickReach ? x : 0] - c.ball.center.x;
    }
    for (int i = 0; i < kBrickReach; ++i) {
      dy[i] = geometry_.coordinate[1][i] - c.ball.center.y;
      const double dz = geometry_.coordinate[2][i] - c.ball.center.z;
      dz2[i] = dz * dz;
    }
    for (int z = 0; z < kBrickReach; ++z) {
      if (dz2[z] > r2) continue;
      for (int y = 0; y < kBrickReach; ++y) {
        const double dyz2 = std::fma(dy[y], dy[y], dz2[z]);
        if (dyz2 > r2) continue;
        std::int64_t* row = inside[z][y];
        for (int x = 0; x < lanes; ++x) row[x] |= std::fma(dx[x], dx[x], dyz2) <= r2 ? 1 : 0;
      }
    }
  }
  for (int z = 0; z < kBrickReach; ++z) {
    for (int y = 0; y < kBrickReach; ++y) {
      std::int64_t bits = 0;
      for (int x = 0; x < kBrickReach; ++x) bits |= inside[z][y][x] << x;
      signs.row[z][y] = static_cast<std::uint16_t>(bits);
    }
  }
  if (geometry_.has_virtual_nodes()) clear_virtual_nodes(geometry_, signs);
}

inline SurfaceVertex UnionBrick::vertex(const CrossedEdge& edge) const {
  const Vec3d node = geometry_.node(edge.inside[0], edge.inside[1], edge.inside[2]);
  const EdgePoint exit =
      first_exit(node, edge.axis, edge.direction, grid_.spacing, [&](auto&& visit) {
        for (std::uint32_t k = 0; k < candidates_.size(); ++k) {
          visit(candidates_[k].ball, candidates_[k].rank, k);
        }
      });
  const Candidate& owner = candidates_[exit.owner];
  Vec3d p = node;
  p[edge.axis] = std::fma(edge.direction, exit.distance, node[edge.axis]);
  Vec3d outward{0, 0, 0};
  outward[edge.axis] = edge.direction;
  return {p, unit_or(p - owner.ball.center, outward), owner.id, exit.clamped};
}

}  // namespace vdwmesh
