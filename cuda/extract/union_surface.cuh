// The vertices of the union of balls on the crossed edges of one brick, for a warp: the device
// counterpart of UnionBrick. The balls near the brick are in shared memory, with float32 copies. A
// lane first uses these copies to find the balls that may touch its edge. To these few it then
// applies the rule for the vertex in double: it is the point at which the edge, followed from its
// inside end, first leaves the union (first_exit()).
#pragma once

#include "cuda/extract/bricks/extract_stages.cuh"
#include "cuda/extract/bricks/kept_bricks.cuh"
#include "cuda/extract/bricks/ordered_gather.cuh"
#include "extract/blended/edge_formulas.hpp"
#include "extract/bricks/brick_geometry.hpp"
#include "extract/bricks/edge_vertex.hpp"

namespace vdwmesh {

// The balls near a brick, in shared memory: rank[k] and place[k] of ball[k].
struct SharedBalls {
  Sphere ball[kMostSharedBalls];
  Rank rank[kMostSharedBalls];
  ListPlace place[kMostSharedBalls];
  // x, y, z: the centre relative to the brick's node 0, Å. w: the squared radius plus a bound on
  // rounding errors, Å². If the squared distance from an edge to the centre is larger, the edge
  // does not touch the ball.
  float4 rough[kMostSharedBalls];

  // Loads the balls at these list places, by one warp. The caller synchronises afterwards.
  // Precondition: count <= kMostSharedBalls.
  __device__ void load(const FieldContext& f, const BrickGeometry& g, const ListPlace* places,
                       std::uint32_t count) {
    for (std::uint32_t k = threadIdx.x % kWarp; k < count; k += kWarp) {
      const Sphere own = f.list.spheres[places[k]];
      ball[k] = own;
      rank[k] = f.list.rank[places[k]];
      place[k] = places[k];
      const Vec3d from = own.center - g.node(0, 0, 0);
      const auto radius = static_cast<float>(own.radius);
      // All lengths below are at most `extent`: a node is at most 9 spacings from node 0 along an
      // axis, and the ball is near the brick. The error of d^2 - r^2, with d the distance and r the
      // radius, is then some 30 units of 2^-24 times extent^2 (derived at NearBalls in
      // union_lanes.hpp); 1e-5 is five times as much.
      const float extent = radius + 2 * kBrickReach * static_cast<float>(f.model.grid.spacing);
      rough[k] = {static_cast<float>(from.x), static_cast<float>(from.y),
                  static_cast<float>(from.z), fmaf(1e-5f * extent, extent, radius * radius)};
    }
  }
};

// The set of balls that may touch the edge: bit k is set if the edge, taken as a box without width,
// is in float32 not further from the centre of ball k than its widened radius. Some balls that just
// miss the edge are included; no ball that touches it is missed.
__device__ inline std::uint64_t balls_near_edge(const SharedBalls& items, std::uint32_t count,
                                                const BrickGeometry& g, const CrossedEdge& edge,
                                                float spacing) {
  const Vec3d node = g.node(edge.inside[0], edge.inside[1], edge.inside[2]) - g.node(0, 0, 0);
  const Vec3f middle = cast<float>(point_on_edge(edge, node, 0.5 * static_cast<double>(spacing)));
  const float half[3] = {edge.axis == 0 ? 0.5f * spacing : 0.0f,
                         edge.axis == 1 ? 0.5f * spacing : 0.0f,
                         edge.axis == 2 ? 0.5f * spacing : 0.0f};
  // A bit for each ball of one half of the set: bits of a word are cheaper to move than those
  // of 64.
  const auto near_among = [&](std::uint32_t begin, std::uint32_t end) {
    std::uint32_t near = 0, bit = 1;
#pragma unroll 4
    for (std::uint32_t k = begin; k < end; ++k, bit += bit) {
      const float4 ball = items.rough[k];
      const float x = fmaxf(fabsf(ball.x - middle.x) - half[0], 0.0f);
      const float y = fmaxf(fabsf(ball.y - middle.y) - half[1], 0.0f);
      const float z = fmaxf(fabsf(ball.z - middle.z) - half[2], 0.0f);
      if (fmaf(x, x, fmaf(y, y, z * z)) <= ball.w) near |= bit;
    }
    return near;
  };
  constexpr std::uint32_t word = kMostSharedBalls / 2;
  static_assert(word == 32);  // the bits of each half
  const std::uint32_t low = near_among(0, count < word ? count : word);
  const std::uint32_t high = near_among(word, count);
  return static_cast<std::uint64_t>(high) << word | low;
}

// The vertex on a crossed edge. `items` has all `count` balls near the brick. If they do not fit in
// shared memory, `items` is null, and the cell list is searched for the balls near the edge.
__device__ inline EdgeVertex union_vertex(const FieldContext& f, const BrickGeometry& g,
                                          const SharedBalls* items, std::uint32_t count,
                                          const CrossedEdge& edge) {
  const double spacing = f.model.grid.spacing;
  const Vec3d node = g.node(edge.inside[0], edge.inside[1], edge.inside[2]);
  std::uint64_t near =
      items ? balls_near_edge(*items, count, g, edge, static_cast<float>(spacing)) : 0;
  const auto for_each = [&](auto&& visit) {
    if (items) {
      for (std::uint64_t left = near; left != 0; left &= left - 1) {
        const int k = __ffsll(static_cast<long long>(left)) - 1;
        // A ball that changes nothing any more is left out from now on.
        if (!visit(items->ball[k], items->rank[k], static_cast<std::uint32_t>(k))) {
          near &= ~(left & -left);
        }
      }
    } else {
      const Vec3d far = g.node(edge.outside[0], edge.outside[1], edge.outside[2]);
      const Vec3d& lower = edge.direction > 0 ? node : far;
      const Vec3d& upper = edge.direction > 0 ? far : node;
      visit_near_box(f.list, lower, upper, [&](ListPlace place) {
        visit(f.list.spheres[place], f.list.rank[place], to_index(place));
        // Visitor of visit_near_box(): false goes on to the next sphere.
        return false;
      });
    }
  };
  const EdgePoint exit = first_exit(node, edge.axis, edge.direction, spacing, for_each);
  const Vec3d p = point_on_edge(edge, node, exit.distance);
  const ListPlace place = items ? items->place[exit.owner] : ListPlace{exit.owner};
  const Vec3d center = items ? items->ball[exit.owner].center : f.list.spheres[place].center;
  const Vec3f normal = unit_or(p - center, edge_direction(edge));
  return {p, normal, f.list.id[place], exit.clamped};
}

}  // namespace vdwmesh
