// What the emission of one brick on the CPU looks up again and again: the vertex on each grid edge
// and where the triangles of each cell begin. Each is worked out once.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "extract/brick_numbering.hpp"

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

// Vertices of the edges of nodes 0 .. 8, those of the brick itself and of its upper neighbours.
class VertexMap {
 public:
  // Where the edges of a cell are, or with axis those of its lower corner.
  static constexpr int place(int x, int y, int z, int axis = 0) {
    return ((z * kBrickReach + y) * kBrickReach + x) * 3 + axis;
  }

  void clear() { number_.fill(kUnknown); }
  void set(int x, int y, int z, int axis, std::uint32_t vertex) {
    number_[static_cast<std::size_t>(place(x, y, z, axis))] = vertex;
  }
  // The vertex on edge e of the cell (x, y, z), whose place is `cell`.
  std::uint32_t of_cell(const BrickList& list, Neighbourhood& near, int cell, int x, int y, int z,
                        int e) {
    std::uint32_t& number = number_[static_cast<std::size_t>(cell + kEdgePlaces[e])];
    if (number == kUnknown) {
      const CellEdge edge = cell_edge(e);
      number = vertex_number(list, locate(near, x + edge.x, y + edge.y, z + edge.z), edge.axis);
    }
    return number;
  }

 private:
  static constexpr std::uint32_t kUnknown = 0xffffffffu;  // no mesh has that many vertices
  static constexpr int kCellEdges = 12;
  struct EdgePlaces {
    int of[kCellEdges];
    constexpr int operator[](int e) const { return of[e]; }
  };
  static constexpr EdgePlaces edge_places() {
    EdgePlaces places{};
    for (int e = 0; e < kCellEdges; ++e) {
      const CellEdge edge = cell_edge(e);
      places.of[e] = ((edge.z * kBrickReach + edge.y) * kBrickReach + edge.x) * 3 + edge.axis;
    }
    return places;
  }
  static const EdgePlaces kEdgePlaces;

  std::array<std::uint32_t, 3 * kBrickReach * kBrickReach * kBrickReach> number_;
};
inline constexpr VertexMap::EdgePlaces VertexMap::kEdgePlaces = VertexMap::edge_places();

// The cells that the surface crosses: their cases, and the triangles of the brick before them.
class CellMap {
 public:
  struct Cell {
    std::uint16_t triangles_before;
    std::uint8_t inside;  // the case
  };

  CellMap(const ActiveBrick& brick, const CaseTable& table) {
    std::uint32_t triangles = 0;
    for (int z = 0; z < kBrickSide; ++z) {
      for (int y = 0; y < kBrickSide; ++y) {
        const std::uint32_t mixed = mixed_cells(brick.signs, y, z);
        for (std::uint32_t cells = mixed; cells != 0; cells &= cells - 1) {
          const int x = std::countr_zero(cells);
          const std::uint32_t inside = cell_case(brick.signs, x, y, z);
          cell_[z][y][x] = {static_cast<std::uint16_t>(triangles),
                            static_cast<std::uint8_t>(inside)};
          triangles += table.count(inside);
        }
      }
    }
  }
  const Cell& at(int x, int y, int z) const { return cell_[z][y][x]; }

 private:
  Cell cell_[kBrickSide][kBrickSide][kBrickSide];  // others are not read
};

}  // namespace vdwmesh
