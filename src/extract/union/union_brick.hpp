// The union of balls on one brick, on the CPU: the signs of its nodes, and the vertices on its
// crossed edges. Both are defined by predicates in double. Float32 filters come first and leave
// little for double to do:
// - Signs: SignFilter computes all signs of the brick in float32. If some node is too near a sphere
//   for float32, all signs are computed again in double.
// - Vertices: EdgeLanes finds in float32 the few balls that may touch each edge. From these, the
//   vertex is computed in double: it is the first exit from the union along the edge, seen from
//   its inside end (union_exit()).
// The filters never change the result, only the time.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "extract/blended/edge_formulas.hpp"
#include "extract/bricks/brick_edges.hpp"
#include "extract/bricks/brick_geometry.hpp"
#include "extract/bricks/edge_vertex.hpp"
#include "extract/field.hpp"
#include "extract/union/ball_run.hpp"
#include "extract/union/sign_lanes.hpp"
#include "extract/union/union_lanes.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// Meets the concept Surface of brick_extraction.hpp. One object works for one thread: visit() moves
// it to a brick, and the other functions compute the signs or vertices of that brick.
class UnionBrick {
 public:
  UnionBrick(const CellListView& list, const FieldModel& model)
      : list_(list), grid_(model.grid), run_(list, model.grid) {}

  // Moves to a brick: gathers the balls that touch the box of its nodes, in the order
  // of the cell list.
  void visit(const BrickIndex& brick);
  void signs(BrickSigns& signs);
  // Calls put(i, vertex) for every edge i of `edges`, which are the brick's crossed edges.
  template <class Put>
  void vertices(const BrickEdges& edges, Put&& put);

 private:
  // The inside end of a crossed edge.
  struct InsideEnd {
    Vec3d node;        // its position, Å
    double direction;  // +1 if the outside end is above it along the edge's axis, else -1
  };

  void signs_in_double(BrickSigns& signs) const;
  void find_touching(const BrickEdges& edges);
  template <int axis>
  InsideEnd inside_end(const BrickEdge& edge) const;
  template <int axis>
  void put_exit(std::size_t e, const InsideEnd& from, const EdgePoint& exit);
  template <int axis>
  void find_exits(const BrickEdges& edges);
  template <int axis>
  void find_shared_exit(std::size_t e, const BrickEdges& edges);
  void find_normals(const BrickEdges& edges);

  const CellListView& list_;
  const GridSpec& grid_;
  BallSearch run_;
  BrickGeometry geometry_{};
  std::vector<ListPlace> places_;  // of the balls that touch the brick
  std::vector<Sphere> balls_;      // these balls; "ball k" below is balls_[k]
  NearBalls near_;                 // these balls in float32
  SignFilter sign_filter_;
  EdgeLanes lanes_;
  // Bit k % 32 of touching_[(k / 32) * EdgeLanes::kMost + e] is set if ball k may touch edge e. The
  // bit is clear only if the ball does not touch the edge.
  std::vector<std::uint32_t> touching_;
  std::vector<std::uint16_t> shared_;  // indices of the edges that several balls may touch
};

inline void UnionBrick::visit(const BrickIndex& brick) {
  geometry_ = brick_geometry(grid_, brick);
  run_.find(geometry_, places_);
  balls_.resize(places_.size());
  for (std::size_t k = 0; k < balls_.size(); ++k) balls_[k] = list_.spheres[places_[k]];
  near_.gather(balls_, geometry_.node(0, 0, 0));
}

inline void UnionBrick::signs(BrickSigns& signs) {
  if (!sign_filter_.signs(near_, geometry_, static_cast<float>(grid_.spacing), signs))
    signs_in_double(signs);
  if (geometry_.has_virtual_nodes()) clear_virtual_nodes(geometry_, signs);
}

// The signs by the predicate inside_ball() in double: every ball marks the nodes that it holds.
inline void UnionBrick::signs_in_double(BrickSigns& signs) const {
  signs = {};
  for (const Sphere& ball : balls_) {
    const double r2 = ball.radius * ball.radius;
    double dx[kBrickReach];
    for (int x = 0; x < kBrickReach; ++x) dx[x] = geometry_.coordinate[0][x] - ball.center.x;
    for (int z = 0; z < kBrickReach; ++z) {
      const double dz = geometry_.coordinate[2][z] - ball.center.z;
      for (int y = 0; y < kBrickReach; ++y) {
        const double dy = geometry_.coordinate[1][y] - ball.center.y;
        // These are the operations of squared_distance() in its order, so the result has the same
        // bits. dx² only adds to dyz2, so if dyz2 is above r2 already, the row has no node in the
        // ball.
        const double dyz2 = std::fma(dy, dy, dz * dz);
        if (dyz2 > r2) continue;
        std::uint32_t bits = 0;
        for (int x = 0; x < kBrickReach; ++x)
          bits |= std::fma(dx[x], dx[x], dyz2) <= r2 ? 1u << x : 0u;
        signs.row[z][y] = static_cast<std::uint16_t>(signs.row[z][y] | bits);
      }
    }
  }
}

// Sets touching_ for all crossed edges. Most edges are touched by one of the brick's balls.
// The balls that do not touch an edge cannot change where the edge leaves the union.
inline void UnionBrick::find_touching(const BrickEdges& edges) {
  lanes_.count = edges.all().size();
  const float half = 0.5f * static_cast<float>(grid_.spacing);
  float offset[3][kBrickReach];
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < kBrickReach; ++i)
      offset[axis][i] =
          static_cast<float>(geometry_.coordinate[axis][i] - geometry_.coordinate[axis][0]);
  }
  for (std::size_t e = 0; e < lanes_.count; ++e) {
    const BrickEdge edge = edges.all()[e];
    lanes_.middle[0][e] = offset[0][edge.x()];
    lanes_.middle[1][e] = offset[1][edge.y()];
    lanes_.middle[2][e] = offset[2][edge.z()];
    lanes_.middle[edge.axis()][e] += half;
  }
  const std::size_t words = (balls_.size() + 31) / 32;
  if (touching_.size() < words * EdgeLanes::kMost) touching_.resize(words * EdgeLanes::kMost);
  for (std::size_t w = 0; w < words; ++w)
    lanes_.find_touching(near_, static_cast<float>(grid_.spacing), 32 * w,
                         touching_.data() + w * EdgeLanes::kMost);
}

template <int axis>
UnionBrick::InsideEnd UnionBrick::inside_end(const BrickEdge& edge) const {
  // `upper` is 1 if the inside end is the upper one. The end is computed by arithmetic instead of a
  // branch, because the processor cannot predict which end is inside.
  const int upper = edge.lower_inside() ? 0 : 1;
  int place[3] = {edge.x(), edge.y(), edge.z()};
  place[axis] += upper;
  return {geometry_.node(place[0], place[1], place[2]), static_cast<double>(1 - 2 * upper)};
}

// Writes the vertex of edge e to lane e. exit.owner is the index in balls_ of the vertex's ball.
template <int axis>
void UnionBrick::put_exit(std::size_t e, const InsideEnd& from, const EdgePoint& exit) {
  Vec3d p = from.node;
  p[axis] = std::fma(from.direction, exit.distance, from.node[axis]);
  for (int i = 0; i < 3; ++i) {
    lanes_.position[i][e] = p[i];
    lanes_.radial[i][e] = p[i] - balls_[exit.owner].center[i];
  }
  lanes_.sphere[e] = list_.id[places_[exit.owner]];
  lanes_.clamped[e] = exit.clamped ? 1 : 0;
}

// The vertices on the edges along an axis. Most edges are touched by one ball only. That ball holds
// the inside node, and the edge leaves the union where it leaves the ball. So a first loop without
// branches computes, for every edge, the exit from the touching ball of lowest index, and collects
// the edges that several balls may touch. A second loop computes these again with the full rule.
// The first loop writes every edge to shared_[shared] and advances `shared` only past edges to be
// kept, so that it has no branch.
template <int axis>
void UnionBrick::find_exits(const BrickEdges& edges) {
  const std::span<const std::uint16_t> along = edges.along<axis>();
  shared_.resize(along.size());
  std::size_t shared = 0;
  for (const std::uint16_t e : along) {
    const std::uint32_t bits = touching_[e];
    shared_[shared] = e;
    const bool several = (bits & (bits - 1)) != 0, unknown = balls_.size() > 32;
    shared += several || unknown ? 1 : 0;
    // `bits` covers balls 0 .. 31 only. It can be 0 only if there are more than 32 balls, because
    // some ball holds the inside node. Then ball 31 exists, the loop uses it for want of a touching
    // ball, and the second loop overwrites the meaningless vertex.
    const auto k = static_cast<std::uint32_t>(std::countr_zero(bits | 1u << 31));
    const InsideEnd from = inside_end<axis>(edges.all()[e]);
    const double distance = exit_of_holder(balls_[k], from.node, axis, from.direction);
    put_exit<axis>(e, from, clamp_to_edge(distance, grid_.spacing, k));
  }
  for (std::size_t i = 0; i < shared; ++i) find_shared_exit<axis>(shared_[i], edges);
}

// The vertex of edge e by the full exit rule, over all balls that may touch the edge.
template <int axis>
void UnionBrick::find_shared_exit(std::size_t e, const BrickEdges& edges) {
  const std::size_t words = (balls_.size() + 31) / 32;
  const InsideEnd from = inside_end<axis>(edges.all()[e]);
  const EdgePoint exit =
      first_exit(from.node, axis, from.direction, grid_.spacing, [&](auto&& visit) {
        for (std::size_t w = 0; w < words; ++w) {
          for (std::uint32_t bits = touching_[w * EdgeLanes::kMost + e]; bits; bits &= bits - 1) {
            const auto k = static_cast<std::uint32_t>(32 * w) +
                           static_cast<std::uint32_t>(std::countr_zero(bits));
            visit(balls_[k], list_.rank[places_[k]], k);
          }
        }
      });
  put_exit<axis>(e, from, exit);
}

// Normals for all edges at once. EdgeLanes::find_normals() returns how many vertices coincide with
// the centre of their ball, so that they have no radial direction. If there are any, all normals
// are computed again with the edge's direction as the fallback.
inline void UnionBrick::find_normals(const BrickEdges& edges) {
  if (lanes_.find_normals() == 0) return;
  for (std::size_t e = 0; e < lanes_.count; ++e) {
    const CrossedEdge edge = edges.all()[e].crossed();
    const Vec3f normal = unit_or({lanes_.radial[0][e], lanes_.radial[1][e], lanes_.radial[2][e]},
                                 edge_direction(edge));
    for (int i = 0; i < 3; ++i) lanes_.normal[i][e] = normal[i];
  }
}

template <class Put>
void UnionBrick::vertices(const BrickEdges& edges, Put&& put) {
  find_touching(edges);
  find_exits<0>(edges);
  find_exits<1>(edges);
  find_exits<2>(edges);
  find_normals(edges);
  const EdgeLanes& l = lanes_;
  for (std::size_t e = 0; e < l.count; ++e) {
    put(e, EdgeVertex{{l.position[0][e], l.position[1][e], l.position[2][e]},
                      {l.normal[0][e], l.normal[1][e], l.normal[2][e]},
                      l.sphere[e],
                      l.clamped[e] != 0});
  }
}

}  // namespace vdwmesh
