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

  void visit(const BrickIndex& brick);
  void signs(BrickSigns& signs) const;
  SurfaceVertex vertex(const CrossedEdge& edge);

 private:
  struct Candidate {
    Sphere ball;
    std::uint32_t rank;
    SphereId id;
  };
  void add(const Candidate& candidate);
  void find_near(const CrossedEdge& edge, const Vec3d& node);

  const CellListView& list_;
  const GridSpec& grid_;
  BrickGeometry geometry_{};
  std::vector<Candidate> candidates_;
  std::vector<double> center_[3], reach2_;  // of the candidates, for all lanes at once
  std::vector<std::int64_t> touches_;
  std::vector<std::uint32_t> near_;  // candidates that the edge at hand can touch
};

// Covers the rounding of a squared distance against the predicate's.
inline constexpr double kTouchMargin = 1 + 1e-12;

inline void UnionBrick::add(const Candidate& candidate) {
  candidates_.push_back(candidate);
  for (int axis = 0; axis < 3; ++axis) center_[axis].push_back(candidate.ball.center[axis]);
  // The second term covers the rounding of `past` in find_near().
  const double radius = candidate.ball.radius;
  reach2_.push_back(radius * radius * kTouchMargin + 1e-14 * radius * grid_.spacing);
}

// Gathers the balls that touch the brick's nodes.
inline void UnionBrick::visit(const BrickIndex& brick) {
  geometry_ = brick_geometry(grid_, brick);
  candidates_.clear();
  for (std::vector<double>& of_axis : center_) of_axis.clear();
  reach2_.clear();
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
    if (d2 <= ball.radius * ball.radius * kTouchMargin) {
      add({ball, list_.rank[place], list_.id[place]});
    }
    return false;
  });
  touches_.resize(candidates_.size());
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

// Few of the brick's balls come near one of its edges; the others cannot change where it leaves the
// union, and the test whether they do takes no root.
inline void UnionBrick::find_near(const CrossedEdge& edge, const Vec3d& node) {
  const int axis = edge.axis, u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  const double length = grid_.spacing, at_u = node[u], at_v = node[v], at = node[axis];
  const double direction = edge.direction;
  const double *cu = center_[u].data(), *cv = center_[v].data(), *c = center_[axis].data();
  const double* reach2 = reach2_.data();
  std::int64_t* touches = touches_.data();
  near_.resize(candidates_.size());
  for (std::size_t k = 0; k < near_.size(); ++k) {
    const double du = at_u - cu[k], dv = at_v - cv[k], along = direction * (c[k] - at);
    // How far from the edge's ends along its line, 0 between them, without a branch.
    const double past = 0.5 * (std::fabs(along) + std::fabs(along - length) - length);
    const double d2 = du * du + dv * dv + past * past;
    touches[k] = d2 <= reach2[k] ? 1 : 0;
  }
  std::size_t found = 0;
  for (std::size_t k = 0; k < near_.size(); ++k) {
    near_[found] = static_cast<std::uint32_t>(k);
    found += static_cast<std::size_t>(touches[k]);
  }
  near_.resize(found);
}

inline SurfaceVertex UnionBrick::vertex(const CrossedEdge& edge) {
  const Vec3d node = geometry_.node(edge.inside[0], edge.inside[1], edge.inside[2]);
  find_near(edge, node);
  const EdgePoint exit =
      first_exit(node, edge.axis, edge.direction, grid_.spacing, [&](auto&& visit) {
        for (const std::uint32_t k : near_) visit(candidates_[k].ball, candidates_[k].rank, k);
      });
  const Candidate& owner = candidates_[exit.owner];
  Vec3d p = node;
  p[edge.axis] = std::fma(edge.direction, exit.distance, node[edge.axis]);
  Vec3d outward{0, 0, 0};
  outward[edge.axis] = edge.direction;
  return {p, unit_or(p - owner.ball.center, outward), owner.id, exit.clamped};
}

}  // namespace vdwmesh
