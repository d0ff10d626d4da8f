// The vertex on each grid edge of one brick, for the emission on the CPU.
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

// Places of the brick's neighbours, each found when first asked for.
class Neighbourhood {
 public:
  Neighbourhood(const BrickList& list, std::uint64_t brick)
      : list_(list), key_(list.bricks[brick].key) {
    found_.fill(kNotSought);
    found_[neighbour_slot(0, 0, 0)] = brick;
  }

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

// Where the corners of a case's triangles are, from the place of the cell's own edges.
struct CornerPlaces {
  std::uint16_t of[256][kCaseHalfEdges];
};

// Vertices of the edges of nodes 0 .. 8, those of the brick itself and of its upper neighbours.
class VertexMap {
 public:
  // Where the edges of a cell are, or with axis those of its lower corner.
  static constexpr int place(int x, int y, int z, int axis = 0) {
    return ((z * kBrickReach + y) * kBrickReach + x) * 3 + axis;
  }
  static CornerPlaces corner_places(const CaseTable& table) {
    CornerPlaces places{};
    for (std::size_t inside = 0; inside < 256; ++inside) {
      for (std::size_t h = 0; h < kCaseHalfEdges; ++h) {
        const CellEdge edge = cell_edge(table.edges[inside][h]);
        places.of[inside][h] = static_cast<std::uint16_t>(place(edge.x, edge.y, edge.z, edge.axis));
      }
    }
    return places;
  }

  // The brick's own, numbered from `first`.
  void set(std::span<const BrickEdge> edges, std::uint64_t first) {
    auto vertex = static_cast<std::uint32_t>(first);
    for (const BrickEdge& e : edges)
      number_[static_cast<std::size_t>(place(e.x(), e.y(), e.z(), e.axis()))] = vertex++;
  }

  // Those of the neighbours on nodes x = 8, y = 8 or z = 8 that the brick's cells touch.
  void set_neighbours(const BrickList& list, const BrickSigns& signs, Neighbourhood& near) {
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

  // Numbers from `place` on; those of edges without a vertex mean nothing.
  const std::uint32_t* from(int place) const { return &number_[static_cast<std::size_t>(place)]; }

 private:
  // Nodes 0 .. 7 of a row of a neighbour.
  void set_row(const BrickList& list, Neighbourhood& near, int y, int z) {
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

  // Rows y whose node x = 8 has a vertex on its edge along y or z that the brick's cells touch.
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

  // Node 8 of a row.
  void set_end(const BrickList& list, Neighbourhood& near, int y, int z) {
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
  static NeighbourRow neighbour_row(const BrickList& list, const Located& at) {
    const ActiveBrick& owner = list.bricks[at.brick];
    return {row_crossings(owner.signs, at.y, at.z),
            static_cast<std::uint32_t>(list.before[at.brick].vertices +
                                       owner.row_vertices[at.z * kBrickSide + at.y])};
  }

  std::array<std::uint32_t, std::size_t{3} * kBrickReach * kBrickReach * kBrickReach> number_{};
};

}  // namespace vdwmesh
