// A table (map) from the grid edges that the cells of one brick touch to the numbers of the
// vertices on them, so that the CPU emits a triangle corner with one look-up. An edge belongs to
// the node at its lower end. The nodes with x, y or z = 8 belong to neighbouring bricks, so the
// numbers of vertices on their edges follow from the counts and signs of these neighbours.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "extract/bricks/brick_edges.hpp"
#include "extract/bricks/brick_numbering.hpp"
#include "extract/bricks/case_table.hpp"

namespace vdwmesh {

// Indices in the brick list of a brick's neighbours. Each is found by a binary search when it is
// first asked for, and then remembered.
class NeighbourCache {
 public:
  NeighbourCache(const BrickList& list, std::uint64_t brick)
      : list_(list), key_(list.bricks[brick].key) {
    found_.fill(kNotSought);
    found_[neighbour_slot(0, 0, 0)] = brick;
  }

  // Index in the list of the neighbour at `slot`. Throws InternalError as find_neighbour() does.
  std::uint64_t operator()(int slot) {
    std::uint64_t& found = found_[static_cast<std::size_t>(slot)];
    if (found == kNotSought) found = find_neighbour(list_, key_, slot);
    return found;
  }

 private:
  static constexpr std::uint64_t kNotSought = ~std::uint64_t{0};
  const BrickList& list_;
  std::uint64_t key_;
  std::array<std::uint64_t, kNeighbours> found_;
};

// of[case][h] is the map index of the edge at which half-edge h starts, less the cell's map index.
struct CornerTable {
  std::uint16_t of[256][kCaseHalfEdges];
};

class VertexMap {
 public:
  // Map index of the edge from node (x, y, z), each 0 .. 8, up along the axis. The map index of
  // cell (x, y, z) is the one for axis 0.
  static constexpr int place(int x, int y, int z, int axis = 0) {
    return ((z * kBrickReach + y) * kBrickReach + x) * 3 + axis;
  }
  static CornerTable corner_places(const CaseTable& table) {
    CornerTable places{};
    for (std::size_t inside = 0; inside < 256; ++inside) {
      for (std::size_t h = 0; h < kCaseHalfEdges; ++h) {
        const CellEdge edge = cell_edge(table.edges[inside][h]);
        places.of[inside][h] = static_cast<std::uint16_t>(place(edge.x, edge.y, edge.z, edge.axis));
      }
    }
    return places;
  }

  // Enters the vertices on the brick's own crossed edges, numbered from `first` on, modulo 2^32.
  void set(std::span<const BrickEdge> edges, std::uint64_t first) {
    auto vertex = static_cast<std::uint32_t>(first);
    for (const BrickEdge& e : edges)
      number_[static_cast<std::size_t>(place(e.x(), e.y(), e.z(), e.axis()))] = vertex++;
  }

  // Enters the neighbours' vertices that the brick's cells need. They lie on edges within the faces
  // x = 8, y = 8 and z = 8 of the brick. Only neighbours with such a vertex are looked up.
  void set_neighbours(const BrickList& list, const BrickSigns& signs, NeighbourCache& near) {
    constexpr std::uint32_t own = (1u << kBrickSide) - 1;
    for (int z = 0; z < kBrickSide; ++z) {
      const std::uint32_t row = signs.row[z][kBrickSide];
      const std::uint32_t crossed = (row ^ row >> 1) | (row ^ signs.row[z + 1][kBrickSide]);
      if ((crossed & own) != 0) set_row(list, near, kBrickSide, z);
    }
    for (int y = 0; y < kBrickReach; ++y) {
      const std::uint32_t row = signs.row[kBrickSide][y];
      const std::uint32_t up = y < kBrickSide ? signs.row[kBrickSide][y + 1] : row;
      if ((((row ^ row >> 1) | (row ^ up)) & own) != 0) set_row(list, near, y, kBrickSide);
    }
    for (int z = 0; z < kBrickReach; ++z) {
      for (std::uint32_t rows = crossed_at_end(signs, z); rows != 0; rows &= rows - 1)
        set_end(list, near, std::countr_zero(rows), z);
    }
  }

  // Vertex numbers, from a map index on. Those of edges that are not crossed have no meaning.
  const std::uint32_t* from(int place) const { return &number_[static_cast<std::size_t>(place)]; }

 private:
  // Enters the vertices of nodes x = 0 .. 7 of a row (y, z) that a neighbour owns. The number rises
  // by one per crossed edge; edges not crossed are written too, so that the loop has no branch.
  void set_row(const BrickList& list, NeighbourCache& near, int y, int z) {
    const NeighbourRow row = neighbour_row(list, locate(near, 0, y, z));
    std::uint32_t vertex = row.first_vertex;
    for (std::uint32_t nodes = row.crossings.nodes(); nodes != 0; nodes &= nodes - 1) {
      const int x = std::countr_zero(nodes);
      for (int axis = 0; axis < 3; ++axis) {
        number_[static_cast<std::size_t>(place(x, y, z, axis))] = vertex;
        vertex += row.crossings.has(x, axis) ? 1 : 0;
      }
    }
  }

  // Bit y: node (8, y, z) has a crossed edge along y or z that the brick's cells touch.
  static std::uint32_t crossed_at_end(const BrickSigns& signs, int z) {
    std::uint32_t rows = 0;
    for (int y = 0; y < kBrickReach; ++y) {
      const std::uint32_t here = signs.row[z][y];
      const std::uint32_t along_y = y < kBrickSide ? here ^ signs.row[z][y + 1] : 0;
      const std::uint32_t along_z = z < kBrickSide ? here ^ signs.row[z + 1][y] : 0;
      rows |= ((along_y | along_z) >> kBrickSide & 1) << y;
    }
    return rows;
  }

  // Enters the vertices of node (8, y, z). It is node 0 of its row in the neighbour that owns it.
  void set_end(const BrickList& list, NeighbourCache& near, int y, int z) {
    const NeighbourRow row = neighbour_row(list, locate(near, kBrickSide, y, z));
    std::uint32_t vertex = row.first_vertex;
    for (int axis = 0; axis < 3; ++axis) {
      number_[static_cast<std::size_t>(place(kBrickSide, y, z, axis))] = vertex;
      vertex += row.crossings.has(0, axis) ? 1 : 0;
    }
  }

  struct NeighbourRow {
    RowCrossings crossings;
    std::uint32_t first_vertex;
  };
  // The crossed edges of a row in its brick, and the number of the first vertex on them.
  static NeighbourRow neighbour_row(const BrickList& list, const OwnerPosition& at) {
    const ActiveBrick& owner = list.bricks[at.brick];
    return {row_crossings(owner.signs, at.y, at.z),
            static_cast<std::uint32_t>(list.before[at.brick].vertices +
                                       owner.row_vertices[at.z * kBrickSide + at.y])};
  }

  std::array<std::uint32_t, std::size_t{3} * kBrickReach * kBrickReach * kBrickReach> number_{};
};

}  // namespace vdwmesh
