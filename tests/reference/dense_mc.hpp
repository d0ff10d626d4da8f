// Marching cubes over a full grid, cell by cell, vertices in a std::map by grid edge.
#pragma once

#include <functional>
#include <map>

#include "reference/point.hpp"

namespace vdwmesh::reference {

using Node = std::array<std::int64_t, 3>;

struct DenseGrid {
  Point origin{0, 0, 0};
  double spacing = 0.5;
  Node cells{0, 0, 0};  // nodes 0 .. cells on every axis

  Point position(const Node& node) const;
  bool contains(const Node& node) const;
};

// The grid edge that leaves `node` along +axis. Nodes at -1 and cells + 1 are the virtual layer.
struct GridEdge {
  Node node;
  int axis;
  friend bool operator==(const GridEdge&, const GridEdge&) = default;
  friend auto operator<=>(const GridEdge&, const GridEdge&) = default;
};

struct DenseMesh {
  TriangleMesh mesh;
  std::map<GridEdge, std::uint32_t> vertex_of_edge;
};

// `inside(node)` for the nodes of the grid; the virtual layer around it is outside, so the mesh is
// closed. `point(inside end, outside end)` places a vertex on its grid edge.
using NodeInside = std::function<bool(const Node&)>;
using EdgePoint = std::function<Point(const Point&, const Point&)>;
DenseMesh dense_marching_cubes(const DenseGrid& grid, const NodeInside& inside,
                               const EdgePoint& point);

}  // namespace vdwmesh::reference
