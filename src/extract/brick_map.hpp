// What the emission of one brick on the CPU looks up again and again: the vertex on each grid edge
// and where the triangles of each cell begin. Each is worked out once.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "extract/brick_cases.hpp"
#include "extract/brick_edges.hpp"
#include "extract/brick_numbering.hpp"
#include "extract/case_table.hpp"

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
      set_row(list, near, kBrickSide, z, 0, (row ^ row >> 1) & own);
      set_row(list, near, kBrickSide, z, 2, row ^ signs.row[z + 1][kBrickSide]);
    }
    for (int y = 0; y < kBrickReach; ++y) {
      const std::uint32_t row = signs.row[kBrickSide][y];
      set_row(list, near, y, kBrickSide, 0, (row ^ row >> 1) & own);
      if (y < kBrickSide) set_row(list, near, y, kBrickSide, 1, row ^ signs.row[kBrickSide][y + 1]);
    }
    // Nodes x = 8 of the rows whose other nodes are the brick's own.
    for (int z = 0; z < kBrickSide; ++z) {
      for (int y = 0; y < kBrickSide; ++y) {
        const std::uint32_t here = signs.row[z][y];
        const std::uint32_t along_y = here ^ signs.row[z][y + 1],
                            along_z = here ^ signs.row[z + 1][y];
        if (((along_y | along_z) >> kBrickSide & 1) == 0) continue;
        set_row(list, near, y, z, 1, along_y & ~own);
        set_row(list, near, y, z, 2, along_z & ~own);
      }
    }
  }

  // Numbers from `place` on; those of edges without a vertex mean nothing.
  const std::uint32_t* from(int place) const { return &number_[static_cast<std::size_t>(place)]; }

 private:
  void set_row(const BrickList& list, Neighbourhood& near, int y, int z, int axis,
               std::uint32_t nodes) {
    for (; nodes != 0; nodes &= nodes - 1) {
      const int x = std::countr_zero(nodes);
      number_[static_cast<std::size_t>(place(x, y, z, axis))] =
          vertex_number(list, locate(near, x, y, z), axis);
    }
  }

  std::array<std::uint32_t, 3 * kBrickReach * kBrickReach * kBrickReach> number_{};
};

// The cells that the surface crosses: their cases, and the triangles of the brick before them.
class CellMap {
 public:
  struct Cell {
    std::uint16_t triangles_before;
    std::uint8_t inside;  // the case
  };

  // Precondition of at().
  void fill(const ActiveBrick& brick, const CaseTable& table) {
    std::uint32_t triangles = 0;
    for_each_mixed_cell(brick.signs, [&](int x, int y, int z, std::uint32_t inside) {
      cell_[z][y][x] = {static_cast<std::uint16_t>(triangles), static_cast<std::uint8_t>(inside)};
      triangles += table.count(inside);
    });
  }
  const Cell& at(int x, int y, int z) const { return cell_[z][y][x]; }

 private:
  Cell cell_[kBrickSide][kBrickSide][kBrickSide];  // others are not read
};

}  // namespace vdwmesh
