#include "reference/dense_mc.hpp"

#include "reference/cell_polygons.hpp"

namespace vdwmesh::reference {
namespace {

Node corner(const Node& cell, int c) {
  return {cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2 & 1)};
}

class Marcher {
 public:
  Marcher(const DenseGrid& grid, const NodeInside& inside, const EdgePoint& point)
      : grid_(grid), point_(point) {
    const Node n = grid.cells;
    signs_.resize(static_cast<std::size_t>((n[0] + 3) * (n[1] + 3) * (n[2] + 3)), 0);
    for (std::int64_t z = 0; z <= n[2]; ++z) {
      for (std::int64_t y = 0; y <= n[1]; ++y) {
        for (std::int64_t x = 0; x <= n[0]; ++x) signs_[index({x, y, z})] = inside({x, y, z});
      }
    }
  }

  DenseMesh run() {
    const Node n = grid_.cells;
    for (std::int64_t z = -1; z <= n[2]; ++z) {
      for (std::int64_t y = -1; y <= n[1]; ++y) {
        for (std::int64_t x = -1; x <= n[0]; ++x) march({x, y, z});
      }
    }
    return std::move(result_);
  }

 private:
  std::size_t index(const Node& node) const {
    const Node n = grid_.cells;
    return static_cast<std::size_t>(((node[2] + 1) * (n[1] + 3) + node[1] + 1) * (n[0] + 3) +
                                    node[0] + 1);
  }

  void march(const Node& cell) {
    unsigned flag = 0;
    for (int c = 0; c < 8; ++c) flag |= signs_[index(corner(cell, c))] ? 1u << c : 0u;
    for (const auto& triangle : cell_triangles(flag)) {
      result_.mesh.triangles.push_back(
          {vertex(cell, triangle[0]), vertex(cell, triangle[1]), vertex(cell, triangle[2])});
    }
  }

  std::uint32_t vertex(const Node& cell, int edge) {
    const CellEdge e = cell_edges()[static_cast<std::size_t>(edge)];
    const Node a = corner(cell, e.a), b = corner(cell, e.b);
    const int axis = a[0] != b[0] ? 0 : a[1] != b[1] ? 1 : 2;
    const auto next = static_cast<std::uint32_t>(result_.mesh.points.size());
    const auto [place, is_new] = result_.vertex_of_edge.try_emplace({a, axis}, next);
    if (is_new) {
      const Point pa = grid_.position(a), pb = grid_.position(b);
      result_.mesh.points.push_back(signs_[index(a)] ? point_(pa, pb) : point_(pb, pa));
    }
    return place->second;
  }

  const DenseGrid& grid_;
  const EdgePoint& point_;
  std::vector<char> signs_;
  DenseMesh result_;
};

}  // namespace

Point DenseGrid::position(const Node& node) const {
  return {origin[0] + spacing * static_cast<double>(node[0]),
          origin[1] + spacing * static_cast<double>(node[1]),
          origin[2] + spacing * static_cast<double>(node[2])};
}

bool DenseGrid::contains(const Node& node) const {
  for (std::size_t a = 0; a < 3; ++a) {
    if (node[a] < 0 || node[a] > cells[a]) return false;
  }
  return true;
}

DenseMesh dense_marching_cubes(const DenseGrid& grid, const NodeInside& inside,
                               const EdgePoint& point) {
  return Marcher(grid, inside, point).run();
}

}  // namespace vdwmesh::reference
