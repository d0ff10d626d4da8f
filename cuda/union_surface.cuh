// The union of balls seen from one brick by a block of threads: node signs from chunks of gathered
// balls, and the vertex on an edge. The device counterpart of UnionBrick.
#pragma once

#include "cuda/extract_stages.cuh"
#include "cuda/ordered_gather.cuh"
#include "extract/brick_geometry.hpp"
#include "extract/edge_formulas.hpp"
#include "extract/surface_vertex.hpp"

namespace vdwmesh {

inline constexpr std::uint32_t kChunk = 128;  // spheres in shared memory at a time

// Squared distance from a point to the box of a brick's nodes.
__device__ inline double square_to_brick(const BrickGeometry& g, const Vec3d& c) {
  double d2 = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double below = g.coordinate[axis][0] - c[axis];
    const double above = c[axis] - g.coordinate[axis][kBrickSide];
    const double d = below > 0 ? below : (above > 0 ? above : 0);
    d2 += d * d;
  }
  return d2;
}

struct UnionSurface {
  struct Item {
    Sphere ball;
    std::uint32_t rank, place;
  };

  __device__ static bool keep(const FieldContext& f, const BrickGeometry& g, std::uint32_t place) {
    const Sphere& ball = f.list.spheres[place];
    return square_to_brick(g, ball.center) <= ball.radius * ball.radius * (1 + 1e-12);
  }

  __device__ static Item item(const FieldContext& f, std::uint32_t place) {
    return {f.list.spheres[place], f.list.rank[place], place};
  }

  // What a thread carries from chunk to chunk for its row of nodes.
  struct RowState {
    std::uint32_t inside = 0;
  };

  __device__ static void add_row(const BrickGeometry& g, const Item* items, std::uint32_t count,
                                 int y, int z, RowState& row) {
    for (std::uint32_t k = 0; k < count; ++k) {
      const Sphere& ball = items[k].ball;
      const double r2 = ball.radius * ball.radius;
      const double dy = g.coordinate[1][y] - ball.center.y, dz = g.coordinate[2][z] - ball.center.z;
      const double dyz2 = std::fma(dy, dy, dz * dz);
      if (dyz2 > r2) continue;
      for (int x = 0; x < kBrickReach; ++x) {
        const double dx = g.coordinate[0][x] - ball.center.x;
        row.inside |= std::fma(dx, dx, dyz2) <= r2 ? 1u << x : 0u;
      }
    }
  }

  // `items` are all spheres near the brick; null when they do not fit, then the list is searched.
  __device__ static SurfaceVertex vertex(const FieldContext& f, const BrickGeometry& g,
                                         const Item* items, std::uint32_t count,
                                         const CrossedEdge& edge) {
    const Vec3d node = g.node(edge.inside[0], edge.inside[1], edge.inside[2]);
    const Vec3d far = g.node(edge.outside[0], edge.outside[1], edge.outside[2]);
    const Vec3d& lower = edge.direction > 0 ? node : far;
    const Vec3d& upper = edge.direction > 0 ? far : node;
    const auto for_each = [&](auto&& visit) {
      if (items) {
        for (std::uint32_t k = 0; k < count; ++k)
          visit(items[k].ball, items[k].rank, items[k].place);
      } else {
        visit_near_box(f.list, lower, upper, [&](std::uint32_t place) {
          visit(f.list.spheres[place], f.list.rank[place], place);
          return false;
        });
      }
    };
    const EdgePoint exit =
        first_exit(node, edge.axis, edge.direction, f.model.grid.spacing, for_each);
    Vec3d p = node, outward{0, 0, 0};
    p[edge.axis] = std::fma(edge.direction, exit.distance, node[edge.axis]);
    outward[edge.axis] = edge.direction;
    return {p, unit_or(p - f.list.spheres[exit.owner].center, outward), f.list.id[exit.owner],
            exit.clamped};
  }
};

}  // namespace vdwmesh
